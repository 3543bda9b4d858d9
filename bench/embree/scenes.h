// What    A scene's primitives in an Embree, as a fast scene and as a robust one, and the numbers that its
//         hits stand for.
// Shape   Each kind's geometry is that of kinds.h. Coordinates are those of kdray's tree
//         (scene/model/geometry.h). A mesh is a scene of Embree's, in its own space as in kdray, and an
//         instance one of its instances.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/embree/library.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::bench::embree {

class Scenes {
 public:
  Scenes(const Library& embree, const scene::Scene& scene);
  ~Scenes();
  Scenes(const Scenes&) = delete;
  Scenes& operator=(const Scenes&) = delete;

  const Library& library() const { return embree_; }
  Scene get(bool robust) const { return robust ? robust_ : fast_; }
  const LocalSpace& space() const { return space_; }  // that rays are to be traced in
  // Of a hit, by Embree's names; `instance` is kNone for the scene's own primitives.
  std::int32_t number_of(unsigned instance, unsigned geometry, unsigned primitive) const {
    const Numbers& numbers = instance == kNone ? numbers_ : of_meshes_[mesh_of_[instance - kFirstInstance]];
    return static_cast<std::int32_t>(numbers[geometry][primitive]);
  }

 private:
  using Numbers = std::array<std::vector<std::uint32_t>, primitives::kKinds>;  // by kind, Embree's geomID
  static constexpr unsigned kFirstInstance = primitives::kKinds;

  Scene build(const scene::Geometry& geometry, SceneFlags flags) const;
  void add_instances(Scene into, const scene::Scene& scene, SceneFlags flags) const;
  void finish(Scene made) const;

  const Library& embree_;
  LocalSpace space_;
  Numbers numbers_;
  std::vector<scene::Geometry> meshes_;
  std::vector<Numbers> of_meshes_;
  std::vector<std::uint32_t> mesh_of_;  // of each instance
  Device device_;
  Scene fast_, robust_;
};

}  // namespace kdray::bench::embree
