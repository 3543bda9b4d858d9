#include "engine/query/queries.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/error.h"
#include "engine/query/chunk_tracer.h"
#include "engine/query/double_rays.h"
#include "engine/query/surface.h"
#include "engine/query/write_hits.h"

namespace kdray::query {

namespace {

template <class Column, class ValueOf>
void fill(const Column& column, std::size_t first, std::size_t n, const ValueOf& value_of) {
  if (column.empty()) return;
  column.fill(first, n, [&](std::size_t ray) { return std::array{value_of(ray - first)}; });
}
template <class ValueOf>
void fill_vectors(const PointsOut& column, std::size_t first, std::size_t n, const ValueOf& value_of) {
  if (column.empty()) return;
  column.fill(first, n, [&](std::size_t ray) {
    const dvec3 v = value_of(ray - first);
    return std::array{v.x, v.y, v.z};
  });
}

// Closest hits of some rays that follow each other.
class HitBlock {
 public:
  // As many as stay in the nearest cache.
  static constexpr std::size_t kMost = 256;

  explicit HitBlock(std::size_t n) : n_(n) {
    std::fill_n(t_.begin(), n, HUGE_VAL);
    std::fill_n(u_.begin(), n, 0);
    std::fill_n(v_.begin(), n, 0);
  }

  void put(std::size_t i, const ExactHit& hit) {
    t_[i] = hit.t;
    u_[i] = hit.u;
    v_[i] = hit.v;
    ref_[i] = hit.ref;
  }

  // To the rows of rays from `first` on; no more is put into it then.
  void write(const QueryContext& context, const RayArrays& rays, const HitsOut& out, std::size_t first) {
    fill(out.t, first, n_, [&](std::size_t i) { return t_[i]; });
    if (context.table.has_instances() || !out.geometry.empty() || !out.primitive.empty())
      write_places(context, out, first);
    else
      fill(out.instance, first, n_, [](std::size_t) { return kNoInstance; });
    fill(out.u, first, n_, [&](std::size_t i) { return u_[i]; });
    fill(out.v, first, n_, [&](std::size_t i) { return v_[i]; });
    const auto point_of = [&](std::size_t i) {
      return rays.origin(first + i) + t_[i] * rays.direction(first + i);
    };
    fill_vectors(out.normal, first, n_, [&](std::size_t i) {
      const auto local = [&] { return context.frame.space().local(point_of(i)); };
      return is_hit(i) ? normal_in_doubles(*context.scene().doubles, ref_[i], local) : dvec3(0);
    });
    fill_vectors(out.point, first, n_,
                 [&](std::size_t i) { return is_hit(i) ? point_of(i) : dvec3(HUGE_VAL); });
  }

 private:
  bool is_hit(std::size_t i) const { return t_[i] != HUGE_VAL; }

  void write_places(const QueryContext& context, const HitsOut& out, std::size_t first) {
    const Numbers numbers(context.scene());
    for (std::size_t i = 0; i < n_; ++i)
      if (is_hit(i)) numbers.fetch(ref_[i]);
    std::array<GeometryTable::Place, kMost> places;
    for (std::size_t i = 0; i < n_; ++i)
      places[i] =
          is_hit(i) ? context.table.of(numbers.of(ref_[i])) : GeometryTable::Place{kNoGeometry, kNoPrimitive};
    for (std::size_t i = 0; i < n_; ++i)
      if (places[i].is_mirrored) std::swap(u_[i], v_[i]);
    fill(out.geometry, first, n_, [&](std::size_t i) { return places[i].geometry; });
    fill(out.primitive, first, n_, [&](std::size_t i) { return places[i].primitive; });
    fill(out.instance, first, n_, [&](std::size_t i) { return places[i].instance; });
  }

  std::size_t n_;
  std::array<double, kMost> t_, u_, v_;  // t is infinite where nothing is hit
  std::array<std::uint32_t, kMost> ref_;
};

// Calls work(first, n) for blocks of [begin, end).
template <class Work>
void for_each_block(std::size_t begin, std::size_t end, const Work& work) {
  for (; begin < end; begin += HitBlock::kMost) work(begin, std::min(HitBlock::kMost, end - begin));
}

void put_closest(const DoubleScene& scene, std::span<const DoubleScene::Question> questions,
                 HitBlock& block) {
  if (questions.empty()) return;
  std::vector<std::optional<ExactHit>> hits(HitBlock::kMost);
  scene.closest(questions, hits);
  for (const DoubleScene::Question& question : questions)
    if (hits[question.place]) block.put(question.place, *hits[question.place]);
}

// What the device has found of blocks of rays, made exact. Its memory serves the next block.
class Settler {
 public:
  explicit Settler(const DoubleRays& rays) : rays_(rays) {}

  // Of the rays from `first` on.
  void settle(std::span<const layout::QueryHit> found, std::size_t first, HitBlock& block) {
    in_doubt_.clear();
    std::size_t n_sure = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::int32_t ref = found[i].primitive;
      if (ref == kInDoubt) {
        if (const auto question = rays_.question(first + i, i)) in_doubt_.push_back(*question);
      } else if (ref >= 0) {
        sure_[n_sure++] = i;
      }
    }
    rays_.scene().tell(
        n_sure, [&](std::size_t k) { return rays_.line(first + sure_[k]); },
        [&](std::size_t k) {
          return static_cast<std::uint32_t>(found[sure_[k]].primitive) & KDRAY_REF_INDEX_MASK;
        },
        [&](std::size_t k, const ExactHit& hit) { block.put(sure_[k], hit); });
    put_closest(rays_.scene(), in_doubt_, block);
  }

 private:
  const DoubleRays& rays_;
  std::vector<DoubleScene::Question> in_doubt_;
  std::array<std::size_t, HitBlock::kMost> sure_;
};

// Of a scene of doubles: of many rays the device tells what floats are sure of
// (primitives/triangle/filter.clh); the host looks at what is in doubt, and finds t, u and v of hits in
// double (double_scene.h). A call of few rays is the host's alone.
QueryReport closest_of_doubles(const QueryContext& context, const RayArrays& arrays, const HitsOut& out,
                               const QueryOptions& options) {
  const DoubleRays rays(context, arrays);
  if (!context.filters(arrays.size()))
    return rays.run(options, [&](std::size_t begin, std::size_t end) {
      for_each_block(begin, end, [&](std::size_t first, std::size_t n) {
        HitBlock block(n);
        put_closest(rays.scene(), rays.questions(first, n), block);
        block.write(context, arrays, out, first);
      });
    });
  const auto take = [&](const Chunk& chunk, std::span<const layout::QueryHit> found, std::size_t begin,
                        std::size_t end) {
    Settler settler(rays);
    for_each_block(begin, end, [&](std::size_t at, std::size_t n) {
      HitBlock block(n);
      settler.settle(found.subspan(at, n), chunk.first + at, block);
      block.write(context, arrays, out, chunk.first + at);
    });
  };
  return trace_chunks(context, arrays, false, true, options, take);
}

QueryReport any_of_doubles(const QueryContext& context, const RayArrays& arrays, const BytesOut& out,
                           const QueryOptions& options) {
  const DoubleRays rays(context, arrays);
  const auto put = [&](std::size_t first, const std::vector<std::uint8_t>& hit) {
    fill(out, first, hit.size(), [&](std::size_t i) { return hit[i]; });
  };
  if (!context.filters(arrays.size()))
    return rays.run(options, [&](std::size_t first, std::size_t last) {
      std::vector<std::uint8_t> hit(last - first);
      rays.scene().any(rays.questions(first, last - first), hit);
      put(first, hit);
    });
  const auto take = [&](const Chunk& chunk, std::span<const layout::QueryHit> found, std::size_t begin,
                        std::size_t end) {
    const std::size_t first = chunk.first + begin;
    std::vector<std::uint8_t> hit(end - begin);
    std::vector<DoubleScene::Question> in_doubt;
    for (std::size_t i = 0; i < hit.size(); ++i) {
      hit[i] = found[begin + i].t == 0;
      if (found[begin + i].primitive != kInDoubt) continue;
      if (const auto question = rays.question(first + i, i)) in_doubt.push_back(*question);
    }
    rays.scene().any(in_doubt, hit);
    put(first, hit);
  };
  return trace_chunks(context, arrays, true, true, options, take);
}

}  // namespace

void check_invalid(const LocalRays& rays, InvalidRays invalid) {
  if (invalid == InvalidRays::error && rays.first_invalid())
    throw Error(ErrorCode::input, *rays.first_invalid());
}

void check_out(std::size_t size, std::size_t n, const char* name) {
  if (size != 0 && size != n)
    throw Error(ErrorCode::input, fmt::format("{}: there are {} places for {} answers", name, size, n));
}

QueryReport closest(const QueryContext& context, const Rays& rays, const HitsOut& out,
                    const QueryOptions& options) {
  const RayArrays arrays(rays);
  const HitWriter writer(context, arrays, out);
  if (context.scene().doubles) return closest_of_doubles(context, arrays, out, options);
  return trace_chunks(
      context, arrays, false, writer.wants_refs(), options,
      [&](const Chunk& chunk, std::span<const layout::QueryHit> hits, std::size_t begin, std::size_t end) {
        writer.write(chunk.first, begin, end, {hits, chunk.session->instances()}, chunk.local);
      });
}

QueryReport any(const QueryContext& context, const Rays& rays, const BytesOut& out,
                const QueryOptions& options) {
  const RayArrays arrays(rays);
  check_out(out.size(), arrays.size(), "hit");
  if (context.scene().doubles) return any_of_doubles(context, arrays, out, options);
  return trace_chunks(
      context, arrays, true, false, options,
      [&](const Chunk& chunk, std::span<const layout::QueryHit> hits, std::size_t begin, std::size_t end) {
        if (out.empty()) return;
        out.fill(chunk.first + begin, end - begin, [&](std::size_t ray) {
          return std::array{static_cast<std::uint8_t>(hits[ray - chunk.first].t == 0)};
        });
      });
}

}  // namespace kdray::query
