// What    Which geometry a primitive belongs to: numbers in file order -> a geometry's id, and the
//         primitive's place in it.
// Shape   Geometries have their numbers in a row, in the order of the table. Primitives of instances have the
//         numbers of their prototypes, or, where instances are copies (scene::DoubleGeometry), numbers of
//         their own behind all others.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kdray/model.h"
#include "scene/model/instances.h"

namespace kdray::query {

class GeometryTable {
 public:
  struct Place {
    GeometryId geometry;
    std::uint32_t primitive;               // of the geometry, or of the instance's prototype
    std::uint32_t instance = kNoInstance;  // of the geometry
    bool is_mirrored = false;              // a copy that is: u and v have changed places
  };

  // The next `n` numbers are this geometry's.
  void add(GeometryId id, std::uint32_t n, std::uint32_t mask);
  // The next `n` instances are this geometry's.
  void add_instances(GeometryId id, std::uint32_t n, std::uint32_t mask);
  // Instances are copies, in the order of the scene's list.
  void set_copies(const scene::Copies& copies) { copies_ = copies; }

  // `instance`: by its place in the scene's list, that of which the primitive is; kNoInstance: of none, or of
  // a copy.
  Place of(std::uint32_t number, std::uint32_t instance = kNoInstance) const;
  bool has_instances() const { return !instances_.empty(); }
  bool has_every_bit() const;  // in all of its masks
  std::uint32_t mask_of(std::uint32_t number) const {
    return is_copied(number) ? mask_of_instance(copy_of(number)) : holder(geometries_, number).mask;
  }
  std::uint32_t mask_of_instance(std::uint32_t instance) const { return holder(instances_, instance).mask; }
  // The geometry that all numbers are of; none: there are several, or none at all, or instances.
  std::optional<GeometryId> only() const;
  std::uint32_t size() const { return next_; }  // numbers in all, but for copies

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
  bool is_copied(std::uint32_t number) const { return copies_.size() > 0 && number >= next_; }
  std::uint32_t copy_of(std::uint32_t number) const;  // the instance's place in the scene's list

  std::vector<Geometry> geometries_;  // that have primitives
  std::vector<Geometry> instances_;   // that have instances
  scene::Copies copies_;
  std::uint32_t next_ = 0, next_instance_ = 0;
};

}  // namespace kdray::query
