// What    Which geometry a primitive belongs to: numbers in file order -> a geometry's id, and the
//         primitive's place in it.
// Shape   Geometries have their numbers in a row, in the order of the table.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kdray/model.h"

namespace kdray::query {

class GeometryTable {
 public:
  struct Place {
    GeometryId geometry;
    std::uint32_t primitive;
  };

  // The next `n` numbers are this geometry's.
  void add(GeometryId id, std::uint32_t n, std::uint32_t mask);

  Place of(std::uint32_t number) const;
  // The geometry that all numbers are of; none: there are several, or none at all.
  std::optional<GeometryId> only() const;
  std::uint32_t size() const { return next_; }  // numbers in all

  // Of each number; empty where every geometry has every bit.
  std::vector<std::uint32_t> masks() const;

 private:
  struct Geometry {
    std::uint32_t first, n;
    GeometryId id;
    std::uint32_t mask;
  };
  std::vector<Geometry> geometries_;  // that have primitives
  std::uint32_t next_ = 0;
};

}  // namespace kdray::query
