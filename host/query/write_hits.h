// What    Hits to the arrays of a program that asked for them.
// Shape   Column by column; where the columns are of floats and words without gaps, as most are, four hits at
//         a time and all columns at once.
// Errors  ErrorCode::input for an array of answers of another size than there are rays.
#pragma once

#include "query/ask.h"

namespace kdray::query {

class HitWriter {
 public:
  HitWriter(const Asked& asked, const RayArrays& rays, const HitsOut& out);

  bool wants_refs() const { return !out_.normal.empty(); }

  // Of rays first + begin to first + end, of which hits[begin] is the first's.
  void write(std::size_t first, std::size_t begin, std::size_t end, std::span<const layout::QueryHit> hits,
             const LocalRays& local) const;

 private:
  void write_columns(std::size_t first, std::size_t begin, std::size_t end,
                     std::span<const layout::QueryHit> hits, const LocalRays& local) const;
  GeometryTable::Place place_of(const layout::QueryHit& hit) const;
  dvec3 point_of(std::size_t ray, double t) const;
  std::array<double, 3> normal_of(std::size_t ray, const layout::QueryHit& hit, double t) const;

  const Asked* asked_;
  const RayArrays* rays_;
  HitsOut out_;
  bool dense_;  // columns of plain_hits.h, or none
};

}  // namespace kdray::query
