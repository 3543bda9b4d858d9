// What    Traces batches of rays with every traversal and asks a question of each hit; counts what is wrong
//         and what differs between the traversals, which must not happen at all.
// Shape   make(i) gives the i-th ray, wrong(i, ray, hit) whether its closest hit is wrong. Rays are made and
//         hits looked at in parallel. Every fourth batch is traced for occlusion too, which must say what the
//         closest hit says.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "kdray/kdray.h"
#include "stress/table.h"

namespace kdray::stress {

struct Walk {
  Traversal traversal;
  const char* name;
};
inline constexpr std::array<Walk, 5> kWalks{{{Traversal::binary, "binary"},
                                             {Traversal::wide, "wide"},
                                             {Traversal::packet, "packet"},
                                             {Traversal::batch, "batch"},
                                             {Traversal::automatic, "auto"}}};
inline constexpr std::size_t kBatch = std::size_t{1} << 18;

// Collects what came of a family, with a row for each traversal.
class Tally {
 public:
  Tally(std::string figure, std::string family) {
    for (std::size_t w = 0; w < kWalks.size(); ++w) rows_[w] = {figure, family, kWalks[w].name};
  }
  Row& row(std::size_t walk) { return rows_[walk]; }
  std::uint64_t differing = 0;               // hits or occlusions that are not the binary walk's, bit for bit
  std::string first_wrong, first_differing;  // in words

  std::uint64_t wrong() const {
    std::uint64_t sum = 0;
    for (const Row& r : rows_) sum += r.wrong;
    return sum;
  }
  void publish() const {
    for (const Row& r : rows_) add(r);
  }

 private:
  std::array<Row, kWalks.size()> rows_;
};

template <class Question>
std::uint64_t count(std::size_t n, const Question& question) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, n, 4096), std::uint64_t{0},
      [&](const tbb::blocked_range<std::size_t>& range, std::uint64_t sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) sum += question(i) ? 1 : 0;
        return sum;
      },
      std::plus<>());
}

template <class Make>
std::vector<Ray> make_rays(std::uint64_t first, std::size_t n, const Make& make) {
  std::vector<Ray> rays(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) rays[i] = make(first + i);
  });
  return rays;
}

inline bool same_bits(const Hit& a, const Hit& b) {
  return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}

std::string in_words(const Ray& ray);
std::string in_words(const Hit& hit);

// Adds the rays whose hits differ from the binary walk's, or whose occlusion does from `hits`, and tells of
// the first.
template <class Differs>
void count_differing(const std::vector<Ray>& rays, const std::vector<Hit>& found,
                     const std::vector<Hit>& reference, const std::string& walk, const Differs& differs,
                     Tally& tally) {
  const std::uint64_t n = count(rays.size(), differs);
  tally.differing += n;
  if (n == 0 || !tally.first_differing.empty()) return;
  std::size_t i = 0;
  while (!differs(i)) ++i;
  tally.first_differing =
      walk + ": " + in_words(rays[i]) + in_words(found[i]) + ", binary" + in_words(reference[i]);
}

// `total` rays, each traced by every walk. `first`: the number of the first.
template <class Make, class Wrong>
void trace_all(Renderer& renderer, std::uint64_t first, std::uint64_t total, const Make& make,
               const Wrong& wrong, Tally& tally) {
  for (std::uint64_t done = 0; done < total; done += kBatch) {
    const std::size_t n = std::min<std::uint64_t>(kBatch, total - done);
    const std::vector<Ray> rays = make_rays(first + done, n, make);
    const bool occlusion_too = done / kBatch % 4 == 0;
    std::vector<Hit> reference;
    for (std::size_t w = 0; w < kWalks.size(); ++w) {
      const std::vector<Hit> hits = renderer.trace(rays, false, 1, kWalks[w].traversal);
      Row& row = tally.row(w);
      const std::uint64_t bad =
          count(n, [&](std::size_t i) { return wrong(first + done + i, rays[i], hits[i]); });
      if (bad != 0 && tally.first_wrong.empty())
        for (std::size_t i = 0; i < n && tally.first_wrong.empty(); ++i)
          if (wrong(first + done + i, rays[i], hits[i]))
            tally.first_wrong = kWalks[w].name + (", ray " + std::to_string(first + done + i)) + ": " +
                                in_words(rays[i]) + in_words(hits[i]);
      row.rays += n;
      row.wrong += bad;
      if (w == 0) reference = hits;
      const auto other = [&](std::size_t i) { return !same_bits(hits[i], reference[i]); };
      count_differing(rays, hits, reference, kWalks[w].name, other, tally);
      if (!occlusion_too) continue;
      const std::vector<Hit> any = renderer.trace(rays, true, 1, kWalks[w].traversal);
      const auto unlike = [&](std::size_t i) { return (any[i].t == 0) != (reference[i].primitive >= 0); };
      row.rays += n;
      count_differing(rays, any, reference, std::string("occlusion, ") + kWalks[w].name, unlike, tally);
    }
  }
}

}  // namespace kdray::stress
