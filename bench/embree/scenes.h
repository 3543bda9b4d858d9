// What    A scene's primitives in Embree, as a fast scene and as a robust one, and the numbers that its hits
//         stand for.
// Shape   Each kind's geometry is that of kinds.h. Coordinates are those of kdray's tree
//         (scene/model/geometry.h). A mesh is a scene of Embree's, in its own space as in kdray, and an
//         instance one of its instances.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/embree/api.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

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
  // Of a hit, by Embree's names; `instance` is RTC_INVALID_GEOMETRY_ID for the scene's own primitives.
  std::int32_t number_of(unsigned instance, unsigned geometry, unsigned primitive) const {
    const Numbers& numbers =
        instance == RTC_INVALID_GEOMETRY_ID ? numbers_ : of_meshes_[mesh_of_[instance - kFirstInstance]];
    return static_cast<std::int32_t>(numbers[geometry][primitive]);
  }

 private:
  using Numbers = std::array<std::vector<std::uint32_t>, primitives::kKinds>;  // by kind, Embree's geomID
  static constexpr unsigned kFirstInstance = primitives::kKinds;

  RTCScene build(const scene::Geometry& geometry, RTCSceneFlags flags) const;
  void add_instances(RTCScene into, const scene::Scene& scene, RTCSceneFlags flags) const;
  void finish(RTCScene made) const;

  LocalSpace space_;
  Numbers numbers_;
  std::vector<scene::Geometry> meshes_;
  std::vector<Numbers> of_meshes_;
  std::vector<std::uint32_t> mesh_of_;  // of each instance
  RTCDevice device_;
  RTCScene fast_, robust_;
};

}  // namespace kdray::bench
