#include "engine/query/queries.h"

#include <fmt/format.h>
#include <tbb/task_group.h>

#include <algorithm>

#include "base/error.h"
#include "base/memory.h"
#include "base/process_memory.h"
#include "engine/query/all_hits.h"
#include "engine/query/double_rays.h"
#include "engine/query/exact_rays.h"
#include "engine/query/grains.h"
#include "engine/query/shared_rows.h"
#include "engine/query/surface.h"

namespace kdray::query {

namespace {

// Rays of a chunk at most, and of the first one; the hits that a chunk is tried to have, since they are held
// beside the answer; and how many are too many for it, unless they are a single ray's.
constexpr std::size_t kCollected = std::size_t{1} << 16, kFirstRays = std::size_t{1} << 10;
constexpr std::size_t kHitsAtOnce = std::size_t{1} << 22, kTooMany = 4 * kHitsAtOnce;
// An answer so small is made without a look at how much memory is free.
constexpr std::uint64_t kSmallAnswer = std::uint64_t{1} << 26;

// The rays of a chunk in the scene's own space, and their masks where primitives have some.
class CollectedRays {
 public:
  CollectedRays(const QueryContext& context, const RayArrays& rays)
      : rays_(&rays),
        local_(rays, context.frame, context.scene().doubles != nullptr),
        masked_(context.has_masks()) {}

  std::span<const Ray> take(std::size_t first, std::size_t n, InvalidRays invalid,
                            const std::optional<Cancel>& cancel) {
    throw_if_cancelled(cancel);
    taken_.resize(n);
    static_assert(sizeof(Ray) == sizeof(layout::QueryRay));
    local_.fill(first, n, reinterpret_cast<layout::QueryRay*>(taken_.data()));
    check_invalid(local_, invalid);
    masks_.resize(masked_ ? n : 0);
    for (std::size_t i = 0; i < masks_.size(); ++i) masks_[i] = rays_->mask(first + i);
    return taken_;
  }

  std::span<const std::uint32_t> masks() const { return masks_; }
  const LocalRays& local() const { return local_; }

 private:
  const RayArrays* rays_;
  LocalRays local_;
  bool masked_;
  std::vector<Ray> taken_;
  std::vector<std::uint32_t> masks_;
};

// The answer, to which chunks' hits are added in turn.
class Answer {
 public:
  Answer(const QueryContext& context, std::size_t n_rays, std::uint64_t max_bytes)
      : context_(&context), n_all_(n_rays), max_bytes_(max_bytes) {
    hits_.splits.reserve(n_rays + 1);
    hits_.splits.push_back(0);
    hits_.more.reserve(n_rays);
  }

  void add(const LocalRays& local, const LocalHits& found) {
    const std::size_t before =
        begin(found.more, [&](std::size_t i) { return found.splits[i + 1] - found.splits[i]; });
    for_each_index(found.more.size(), [&](std::size_t i) {
      for (std::size_t k = found.splits[i]; k < found.splits[i + 1]; ++k) {
        const std::uint32_t instance = found.instance.empty() ? kNoInstance : found.instance[k];
        put(before + k, local.world_t(i, found.t[k]), found.u[k], found.v[k], found.primitive[k], instance);
      }
    });
  }

  // Of rays of doubles: hits by reference, and instances by index.
  void add(const ExactHits& found) {
    begin(found.more, [&](std::size_t i) { return found.of(i).size(); });
    const std::size_t first = hits_.more.size() - found.more.size();
    const flatten::FlatScene& flat = context_->scene().flat;
    const Numbers numbers(context_->scene());
    constexpr std::size_t kAhead = 8;  // rays
    for_each_index(found.more.size(), [&](std::size_t i) {
      if (i + kAhead < found.more.size())
        for (const ExactHit& hit : found.of(i + kAhead)) numbers.fetch(hit.ref);
      std::size_t at = hits_.splits[first + i];
      for (const ExactHit& hit : found.of(i)) {
        const bool placed = hit.instance != kNoInstance;
        put(at++, hit.t, hit.u, hit.v, numbers.of(hit.ref),
            placed ? flat.instances[hit.instance].number : kNoInstance);
      }
    });
  }

  AllHits take(std::uint64_t n_invalid) {
    hits_.report.invalid = n_invalid;
    return std::move(hits_);
  }

 private:
  static constexpr std::uint64_t kBytesPerHit =
      sizeof(double) + 2 * sizeof(float) + 3 * sizeof(std::uint32_t);

  // Makes space for more rays with their hits: where these begin.
  template <class CountOf>
  std::size_t begin(const auto& more, const CountOf& count_of) {
    const std::size_t before = hits_.t.size();
    n_rays_ += more.size();
    std::size_t n = before;
    for (std::size_t i = 0; i < more.size(); ++i) hits_.splits.push_back(n += count_of(i));
    hits_.more.insert(hits_.more.end(), more.begin(), more.end());
    grow_to(n);
    return before;
  }

  // For n hits; and at once for all that there will be, if the other rays have as many and there is memory.
  void grow_to(std::size_t n) {
    if (hits_.t.capacity() < n) {
      const double all =
          1.05 * static_cast<double>(n) * static_cast<double>(n_all_) / static_cast<double>(n_rays_);
      const std::size_t most = most_hits(n);
      const std::size_t wanted =
          std::max(n, static_cast<std::size_t>(std::min(all, static_cast<double>(most))));
      const auto reserve = [&](auto& array) {
        array.reserve(wanted);
        prefer_large_pages(array.data(), array.capacity() * sizeof(array[0]));
      };
      reserve(hits_.t), reserve(hits_.geometry), reserve(hits_.primitive), reserve(hits_.u), reserve(hits_.v);
      reserve(hits_.instance);
    }
    hits_.t.resize(n), hits_.geometry.resize(n), hits_.primitive.resize(n), hits_.u.resize(n),
        hits_.v.resize(n);
    hits_.instance.resize(n);
  }

  // How many hits the answer can have, of which there are n. While an array grows there are two of it.
  std::size_t most_hits(std::size_t n) const {
    const std::uint64_t held = hits_.t.capacity() * kBytesPerHit, needed = n * kBytesPerHit;
    std::uint64_t most = max_bytes_;
    if (most == 0) {
      if (needed <= kSmallAnswer) return kSmallAnswer / kBytesPerHit;
      const std::uint64_t free = free_memory(), twice = hits_.t.capacity() * sizeof(double);
      most = held + (free > twice ? free - twice : 0);
    }
    if (needed > most)
      throw Error(
          ErrorCode::out_of_memory,
          fmt::format(
              "all hits: the first {} of {} rays have {} hits, which take {} bytes, and {} are {}; ask "
              "for the first hits of each ray alone (max_hits), or for fewer rays at a time",
              n_rays_, n_all_, n, needed, most, max_bytes_ == 0 ? "free" : "allowed (max_bytes)"));
    return most / kBytesPerHit;
  }

  // `instance`: by its place in the scene's list.
  void put(std::size_t at, double t, double u, double v, std::uint32_t number, std::uint32_t instance) {
    const GeometryTable::Place place = context_->table.of(number, instance);
    hits_.t[at] = t;
    hits_.geometry[at] = place.geometry;
    hits_.primitive[at] = place.primitive;
    hits_.u[at] = static_cast<float>(place.is_mirrored ? v : u);
    hits_.v[at] = static_cast<float>(place.is_mirrored ? u : v);
    hits_.instance[at] = place.instance;
  }

  const QueryContext* context_;
  std::size_t n_all_, n_rays_ = 0;  // rays there are, and that were added
  std::uint64_t max_bytes_;
  AllHits hits_;
};

}  // namespace

QueryReport count(const QueryContext& context, const Rays& rays, const WordsOut& out,
                  const QueryOptions& options) {
  const RayArrays arrays(rays);
  check_out(out.size(), arrays.size(), "counts");
  const bool of_doubles = context.scene().doubles != nullptr;
  if (of_doubles && !context.filters(arrays.size())) {
    const DoubleRays in_doubles(context, arrays);
    return in_doubles.run(options, [&](std::size_t first, std::size_t last) {
      if (out.empty()) return;
      std::vector<std::uint32_t> counts(last - first);
      in_doubles.scene().count(in_doubles.questions(first, last - first), counts);
      out.fill(first, last - first, [&](std::size_t i) { return std::array{counts[i - first]}; });
    });
  }
  const auto work = [&](Place& place, RowTaker& rows, const std::optional<Cancel>& cancel) {
    CollectedRays collected(context, arrays);
    const Sessions<Passes>::Borrowed passes = place.sessions.crossings.borrow();
    std::vector<std::uint32_t> counts;
    Pace pace(kFirstRays, kCollected, place.sessions.counted_at_once);
    for (RowRange next = rows.take(pace.take()); next.n > 0; next = rows.take(pace.take())) {
      const std::span<const Ray> taken = collected.take(next.first, next.n, options.invalid, cancel);
      counts.resize(taken.size());
      count_hits(*passes, taken, {.masks = collected.masks(), .cancel = cancel}, counts);
      if (of_doubles)
        DoubleRays(context, arrays).count_in_doubt(next.first, counts, cancel);
      else if (arrays.in_double())
        ExactRays(context, arrays).count(next.first, counts, cancel);
      if (!out.empty())
        out.fill(next.first, next.n, [&](std::size_t ray) { return std::array{counts[ray - next.first]}; });
      pace.done(next.n);
    }
    return QueryReport{collected.local().n_invalid()};
  };
  return share_rows(context, arrays.size(), kFirstRays, options.cancel, work);
}

namespace {

// All hits of the rays that a place takes. While a chunk is traced, the hits of the one before it are added
// to the answer, in the rays' order.
class Collector {
 public:
  Collector(const QueryContext& context, Place& place, const RayArrays& rays, const AllHitsOptions& options,
            Answer& answer)
      : options_(options),
        answer_(answer),
        exact_(rays.in_double() || context.scene().doubles != nullptr),
        context_(context),
        rays_(rays),
        chunks_{{context, rays}, {context, rays}},
        passes_(place.sessions.crossings.borrow()),
        pace_(kFirstRays, kCollected, place.sessions.collected_at_once) {}
  Collector(const Collector&) = delete;
  Collector& operator=(const Collector&) = delete;
  ~Collector() {
    adding_.cancel();
    try {
      adding_.wait();
    } catch (...) {  // another error is on its way
    }
  }

  QueryReport run(RowTaker& rows, const std::optional<Cancel>& cancel) {
    for (RowRange next = rows.take(pace_.take()); next.n > 0; next = rows.take(pace_.take()))
      while (next.n > 0) {
        const std::size_t n = trace(next.first, std::min(next.n, pace_.take()), cancel);
        if (n == 0) continue;  // too many hits: fewer rays at a time
        adding_.wait();
        if (!rows.all().wait_for_turn(next.first)) return {};
        add(rows.all(), n, next.first + n == rows.all().size());
        next = {next.first + n, next.n - n};
      }
    adding_.wait();
    return {chunks_[0].rays.local().n_invalid() + chunks_[1].rays.local().n_invalid()};
  }

 private:
  struct Chunk {
    Chunk(const QueryContext& context, const RayArrays& rays) : rays(context, rays) {}
    CollectedRays rays;
    LocalHits found;
    ExactHits exact;
  };

  // Returns 0 where they have more hits than fit.
  std::size_t trace(std::size_t first, std::size_t n, const std::optional<Cancel>& cancel) {
    Chunk& chunk = chunks_[turn_];
    const std::span<const Ray> taken = chunk.rays.take(first, n, options_.invalid, cancel);
    const CollectOptions collect{.max_hits = options_.max_hits,
                                 .masks = chunk.rays.masks(),
                                 .as_refs = exact_,
                                 .cancel = cancel,
                                 .at_once = n > 1 ? kTooMany : SIZE_MAX};
    if (!query::all_hits(*passes_, taken, collect, chunk.found)) {
      pace_.done(n, n / 8);
      return 0;
    }
    pace_.done(n, kHitsAtOnce * n / std::max<std::size_t>(chunk.found.t.size(), 1));
    if (context_.scene().doubles)
      chunk.exact = DoubleRays(context_, rays_).settle(first, chunk.found, options_.max_hits, cancel);
    else if (exact_)
      chunk.exact = ExactRays(context_, rays_).settle(first, chunk.found, options_.max_hits, cancel);
    return n;
  }

  void add(SharedRows& rows, std::size_t n, bool are_last) {
    const auto work = [this, &rows, n, &chunk = chunks_[turn_]] {
      exact_ ? answer_.add(chunk.exact) : answer_.add(chunk.rays.local(), chunk.found);
      rows.put_together(n);
    };
    are_last ? work() : adding_.run(work);
    turn_ ^= 1;
  }

  const AllHitsOptions& options_;
  Answer& answer_;
  bool exact_;
  const QueryContext& context_;
  const RayArrays& rays_;
  Chunk chunks_[2];
  std::size_t turn_ = 0;
  Sessions<Passes>::Borrowed passes_;
  Pace pace_;
  tbb::task_group adding_;
};

}  // namespace

namespace {

// Of few rays, by the host.
AllHits all_of_doubles(const QueryContext& context, const RayArrays& arrays, const AllHitsOptions& options,
                       Answer& answer) {
  const DoubleRays in_doubles(context, arrays);
  const std::uint64_t n_invalid = in_doubles.check(options.invalid);
  answer.add(in_doubles.all(options.max_hits, options.cancel));
  return answer.take(n_invalid);
}

}  // namespace

AllHits all(const QueryContext& context, const Rays& rays, const AllHitsOptions& options) {
  const RayArrays arrays(rays);
  Answer answer(context, arrays.size(), options.max_bytes);
  if (context.scene().doubles && !context.filters(arrays.size()))
    return all_of_doubles(context, arrays, options, answer);
  const QueryReport report =
      share_rows(context, arrays.size(), kFirstRays, options.cancel,
                 [&](Place& place, RowTaker& rows, const std::optional<Cancel>& cancel) {
                   return Collector(context, place, arrays, options, answer).run(rows, cancel);
                 });
  return answer.take(report.invalid);
}

}  // namespace kdray::query
