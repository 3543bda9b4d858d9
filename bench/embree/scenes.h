// What    A scene's primitives in Embree, as a fast scene and as a robust one, and the numbers that its hits
//         stand for.
// Shape   Triangles are triangles, spheres SPHERE_POINTs, cones CONE_LINEAR_CURVEs whose segments are flagged
//         as having neighbours, which leaves the end caps off, discs ORIENTED_DISC_POINTs. Coordinates are
//         those of kdray's tree (scene/geometry.h). A kind that has no type here does not compile.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/embree/api.h"
#include "scene/geometry.h"
#include "scene/scene.h"

namespace kdray::bench {

// Throws ErrorCode::internal where Embree gives none.
RTCDevice open_embree();

// A curve's flags without end caps.
inline constexpr std::uint8_t kOpenCone = RTC_CURVE_FLAG_NEIGHBOR_LEFT | RTC_CURVE_FLAG_NEIGHBOR_RIGHT;

constexpr RTCGeometryType embree_type(primitives::TriangleKind) {
  return RTC_GEOMETRY_TYPE_TRIANGLE;
}
constexpr RTCGeometryType embree_type(primitives::SphereKind) {
  return RTC_GEOMETRY_TYPE_SPHERE_POINT;
}
constexpr RTCGeometryType embree_type(primitives::ConeKind) {
  return RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE;
}
constexpr RTCGeometryType embree_type(primitives::DiscKind) {
  return RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT;
}

class EmbreeScenes {
 public:
  explicit EmbreeScenes(const scene::Scene& scene);
  ~EmbreeScenes();
  EmbreeScenes(const EmbreeScenes&) = delete;
  EmbreeScenes& operator=(const EmbreeScenes&) = delete;

  RTCScene get(bool robust) const { return robust ? robust_ : fast_; }
  const LocalSpace& space() const { return space_; }  // that rays are to be traced in
  std::int32_t number_of(unsigned geometry, unsigned primitive) const {
    return static_cast<std::int32_t>(numbers_[geometry][primitive]);
  }

 private:
  RTCScene build(const scene::Geometry& geometry, RTCSceneFlags flags);

  LocalSpace space_;
  std::array<std::vector<std::uint32_t>, primitives::kKinds> numbers_;  // by kind, Embree's geomID
  RTCDevice device_;
  RTCScene fast_, robust_;
};

}  // namespace kdray::bench
