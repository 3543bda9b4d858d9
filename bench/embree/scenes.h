// What    A scene's primitives in Embree, as a fast scene and as a robust one, and the numbers that its hits
//         stand for.
// Shape   Each kind's geometry is that of kinds.h. Coordinates are those of kdray's tree (scene/geometry.h).
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
