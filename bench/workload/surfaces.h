// What    The normal of a scene's primitive at a point of it, found by the primitive's number.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::bench {

class Surfaces {
 public:
  explicit Surfaces(const scene::Scene& scene);  // which has to outlive this

  // Unit length, of the surface itself (not interpolated); which side it points to is the primitive's affair.
  dvec3 normal(std::uint32_t number, const dvec3& point) const;

 private:
  struct Entry {
    std::uint32_t kind, index;
  };

  const scene::Scene& scene_;
  std::vector<Entry> entries_;  // by number
};

}  // namespace kdray::bench
