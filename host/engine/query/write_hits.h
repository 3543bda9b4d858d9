// What    Hits to the arrays of a program that asked for them.
// Shape   Column by column; where the columns are of floats and words without gaps, as most are, four hits at
//         a time and all columns at once.
// Errors  ErrorCode::input for an array of answers of another size than there are rays.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/query/exact_rays.h"
#include "engine/query/queries.h"

namespace kdray::query {

// Of the rays of a chunk; instances by index, or none where the scene has none.
struct FoundHits {
  std::span<const layout::QueryHit> hits;
  std::span<const std::uint32_t> instances;

  FoundHits part(std::size_t first, std::size_t n) const {
    return {hits.subspan(first, n), instances.empty() ? instances : instances.subspan(first, n)};
  }
};

class HitWriter {
 public:
  HitWriter(const QueryContext& context, const RayArrays& rays, const HitsOut& out);

  // Whether hits are to be named by references: for their normals, or to look at them in double.
  bool wants_refs() const { return !out_.normal.empty() || exact_; }

  // Of rays first + begin to first + end, of which hits[begin] is the first's.
  void write(std::size_t first, std::size_t begin, std::size_t end, const FoundHits& found,
             const LocalRays& local) const;

 private:
  // Some hits, whose rays' numbers begin at `ray`, and in the chunk at `at`.
  struct Some {
    std::size_t ray, at;
    std::span<const layout::QueryHit> hits;
    std::span<const std::uint32_t> instances;
    const LocalRays& local;
    std::span<const double> t = {};  // of rays of doubles

    std::uint32_t instance(std::size_t i) const { return instances.empty() ? kNoInstance : instances[i]; }
    // The t of a miss is infinite, and stays so.
    double t_of(std::size_t i, const layout::QueryHit& hit) const {
      return t.empty() ? local.world_t(at + i, hit.t) : t[i];
    }
  };
  static constexpr std::size_t kRows = 512;  // these stay in the nearest cache for all columns
  // Hits that are changed on their way: named by their numbers, or looked at in double.
  struct Changed {
    std::array<layout::QueryHit, kRows> hits;
    std::array<std::uint32_t, kRows> instances;
    std::array<double, kRows> t;
  };

  void settle(Some& some, Changed& changed) const;
  void name(Some& some, Changed& changed) const;
  std::size_t write_dense(const Some& some) const;
  void write_columns(const Some& some, std::size_t from) const;
  template <class Column, class ValueOf>
  void fill(const Column& column, const Some& some, std::size_t from, const ValueOf& value_of) const;
  dvec3 point_of(std::size_t ray, double t) const;
  dvec3 normal_of(const Some& some, std::size_t i, layout::QueryHit& hit) const;

  const QueryContext* context_;
  const RayArrays* rays_;
  HitsOut out_;
  std::optional<ExactRays> exact_;  // of rays of doubles
  bool dense_;                      // columns without gaps, of one geometry
};

}  // namespace kdray::query
