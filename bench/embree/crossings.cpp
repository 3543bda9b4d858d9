// What    All hits of rays, and their number, by Embree's filter functions.
#include <numeric>

#include "bench/embree/asker.h"

namespace kdray::bench::embree {

namespace {

struct Crossing {
  std::uint32_t ray;  // of the grain
  float t;
  std::uint32_t geometry, primitive;
  float u, v;
};

bool comes_before(const Crossing& a, const Crossing& b) {
  if (a.ray != b.ray) return a.ray < b.ray;
  return a.t != b.t ? a.t < b.t : a.primitive < b.primitive;
}

// Calls note(lane, ray's number) for each valid hit, and accepts none.
template <class Note>
void refuse_all(const FilterArguments* args, const Note& note) {
  for (unsigned lane = 0; lane < args->n; ++lane) {
    if (args->valid[lane] == 0) continue;
    note(lane, at<std::uint32_t>(args, RayRow::id, lane));
    args->valid[lane] = 0;
  }
}

// Traces rays [first + begin, first + end) for what the scene's filter notes of them with `user`.
template <unsigned N>
void trace_through(const OwnedScene& scene, bool coherent, const QuerySet& set, std::size_t first,
                   std::size_t end, void* user) {
  Query query(scene.library(), coherent, user);
  const auto put = [&, put = rays_from(set)](Rays<N>& rays, unsigned lane, std::size_t i) {
    put(rays, lane, i);
    rays.id[lane] = static_cast<unsigned>(i - first);
  };
  trace_rays<N, true>(scene.get(), query, first, end, put, [](auto&, unsigned, std::size_t) {});
}

// Packets are never flagged as coherent: their walk (of 3.13.5) calls the filter several times for a hit,
// where there are several hits, and counts would be wrong.
void trace_through(const OwnedScene& scene, const RayForm& form, const QuerySet& set, std::size_t first,
                   std::size_t end, void* user) {
  form.lanes == 1 ? trace_through<1>(scene, form.coherent, set, first, end, user)
                  : trace_through<16>(scene, false, set, first, end, user);
}

// The crossings of a grain to where they belong, from place `at` on.
void place(const std::vector<Crossing>& found, std::size_t at, AllHits& all) {
  for (const Crossing& c : found) {
    all.t[at] = c.t;
    all.geometry[at] = c.geometry;
    all.primitive[at] = c.primitive;
    all.u[at] = c.u;
    all.v[at] = c.v;
    ++at;
  }
}

}  // namespace

void note_count(const FilterArguments* args) {
  auto* const counts = static_cast<std::uint32_t*>(user_of(args));
  refuse_all(args, [&](unsigned, unsigned ray) { ++counts[ray]; });
}

void note_hit(const FilterArguments* args) {
  auto& found = *static_cast<std::vector<Crossing>*>(user_of(args));
  refuse_all(args, [&](unsigned lane, unsigned ray) {
    // The hit's distance is where the ray ends, as long as the filter looks at it.
    found.push_back({ray, at<float>(args, RayRow::t_far, lane),
                     at<std::uint32_t>(args, HitRow::geometry, lane),
                     at<std::uint32_t>(args, HitRow::primitive, lane), at<float>(args, HitRow::u, lane),
                     at<float>(args, HitRow::v, lane)});
  });
}

void count_crossings(Mesh& mesh, const RayForm& form, const QuerySet& set, std::size_t first, std::size_t n,
                     std::vector<std::uint32_t>& counts) {
  mesh.workers.run(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::fill_n(counts.begin() + static_cast<std::ptrdiff_t>(first + begin), end - begin, 0u);
    trace_through(mesh.counting, form, set, first + begin, first + end, &counts[first + begin]);
  });
}

AllHits all_crossings(Mesh& mesh, const RayForm& form, const QuerySet& set, std::size_t first,
                      std::size_t n) {
  std::vector<std::vector<Crossing>> found(Workers::grains(n));
  AllHits all;
  all.splits.assign(n + 1, 0);
  all.more.assign(n, 0);
  mesh.workers.run(n, [&](std::size_t grain, std::size_t begin, std::size_t end) {
    trace_through(mesh.collecting, form, set, first + begin, first + end, &found[grain]);
    std::sort(found[grain].begin(), found[grain].end(), comes_before);
    for (const Crossing& c : found[grain]) ++all.splits[begin + c.ray + 1];
  });
  std::partial_sum(all.splits.begin(), all.splits.end(), all.splits.begin());
  all.t.resize(all.splits.back());
  for (auto* words : {&all.geometry, &all.primitive}) words->resize(all.t.size());
  for (auto* values : {&all.u, &all.v}) values->resize(all.t.size());
  mesh.workers.run(n, [&](std::size_t grain, std::size_t begin, std::size_t) {
    place(found[grain], all.splits[begin], all);
  });
  return all;
}

}  // namespace kdray::bench::embree
