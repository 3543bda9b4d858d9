// What    Scenes of an Embree, released with these objects, with quality medium; of a scene of kdray's a fast
//         one and a robust one, and the numbers that their hits stand for.
// Shape   Each kind's geometry is that of kinds.h. Coordinates are those of kdray's tree
//         (scene/model/geometry.h). A mesh is a scene of Embree's, in its own space as in kdray, and an
//         instance one of its instances.
// Errors  ErrorCode::internal where Embree refuses what it is given.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "bench/embree/kinds.h"
#include "bench/embree/library.h"

namespace kdray::bench::embree {

class OwnedScene {
 public:
  OwnedScene(std::shared_ptr<const OpenDevice> device, bool robust);
  ~OwnedScene() { library().release_scene(scene_); }
  OwnedScene(const OwnedScene&) = delete;
  OwnedScene& operator=(const OwnedScene&) = delete;

  const Library& library() const { return device_->library(); }
  Scene get() const { return scene_; }

  // A geometry for each kind of which there are any; its number is the kind's. The buffers have to outlive
  // the scene. `filter`: null, or called for every hit of occlusion rays.
  void add(const KindBuffers& buffers, Filter filter = nullptr);
  void add_instance(const OwnedScene& of, const float (&columns)[12], unsigned number);
  void commit();

 private:
  void attach(Geometry geometry, unsigned number);

  std::shared_ptr<const OpenDevice> device_;
  Scene scene_;
};

class Scenes {
 public:
  Scenes(const Library& embree, const scene::Scene& scene);

  const Library& library() const { return device_->library(); }
  Scene get(bool robust) const { return (robust ? robust_ : fast_)->get(); }
  const LocalSpace& space() const { return own_.space; }  // that rays are to be traced in
  // Of a hit, by Embree's names; `instance` is kNone for the scene's own primitives.
  std::int32_t number_of(unsigned instance, unsigned geometry, unsigned primitive) const {
    const Part& part = instance == kNone ? own_ : *meshes_[mesh_of_[instance - kFirstInstance]];
    return static_cast<std::int32_t>(part.numbers[geometry][primitive]);
  }

 private:
  using Numbers = std::array<std::vector<std::uint32_t>, primitives::kKinds>;  // by kind, Embree's geomID
  static constexpr unsigned kFirstInstance = primitives::kKinds;

  // The scene's own primitives, or a mesh.
  struct Part {
    Part(const scene::Scene& scene, const scene::Geometry& geometry);

    LocalSpace space;
    Numbers numbers;
    KindBuffers buffers;
  };

  std::unique_ptr<OwnedScene> make(const scene::Scene& scene, bool robust) const;

  std::shared_ptr<const OpenDevice> device_;
  Part own_;
  std::vector<std::unique_ptr<Part>> meshes_;
  std::vector<std::uint32_t> mesh_of_;  // of each instance
  std::unique_ptr<OwnedScene> fast_, robust_;
};

}  // namespace kdray::bench::embree
