// What    Which geometry a primitive belongs to: numbers in file order -> a geometry's id, and the
//         primitive's place in it.
// Shape   Geometries have their numbers in a row, in the order of the table.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kdray/model.h"

namespace kdray::query {

class GeometryTable {
 public:
  struct Place {
    GeometryId geometry;
    std::uint32_t primitive;
  };

  struct InstancePlace {
    GeometryId geometry;
    std::uint32_t instance;
  };

  // The next `n` numbers are this geometry's.
  void add(GeometryId id, std::uint32_t n, std::uint32_t mask);
  // The next `n` instances are this geometry's. Their primitives have the numbers of their prototypes.
  void add_instances(GeometryId id, std::uint32_t n, std::uint32_t mask);

  Place of(std::uint32_t number) const;
  InstancePlace of_instance(std::uint32_t instance) const;  // by its place in the scene's list
  std::uint32_t mask_of(std::uint32_t number) const { return holder(geometries_, number).mask; }
  std::uint32_t mask_of_instance(std::uint32_t instance) const { return holder(instances_, instance).mask; }
  // The geometry that all numbers are of; none: there are several, or none at all, or instances.
  std::optional<GeometryId> only() const;
  std::uint32_t size() const { return next_; }  // numbers in all

  // Of each number; empty where every geometry has every bit. Where there are instances: the place in the
  // list where those of the numbers begin, those of the instances, and those of the numbers.
  // `instances`: the places in the scene's list of those that there are.
  std::vector<std::uint32_t> masks(std::span<const std::uint32_t> instances = {}) const;

 private:
  struct Geometry {
    std::uint32_t first, n;
    GeometryId id;
    std::uint32_t mask;
  };
  static const Geometry& holder(const std::vector<Geometry>& geometries, std::uint32_t number);

  std::vector<Geometry> geometries_;  // that have primitives
  std::vector<Geometry> instances_;   // that have instances
  std::uint32_t next_ = 0, next_instance_ = 0;
};

}  // namespace kdray::query
