// What    Judges closest hits in a scene with instances by copies of their meshes, in double and one by one.
// Shape   Of each primitive it is known for certain that a ray hits it, or that it doesn't, or neither: where
//         the ray passes an outline, or an edge, by less than the ray in the mesh may be off
//         (host/accel/flatten/instances.h). What is certain is demanded; what is not may be told or not.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kdray/ray.h"
#include "scene/model/scene.h"

namespace kdray::test {

class InstanceJudge {
 public:
  explicit InstanceJudge(const scene::Scene& scene);

  // What is wrong with a hit, in words, or nothing. `instance`: its place in the scene's list, or kNone.
  std::string wrong(const Ray& ray, const Hit& hit, std::uint32_t instance) const;

  struct Crossing {
    double t;
    std::uint32_t instance, primitive;
  };
  // The same of all hits of a ray.
  std::string wrong(const Ray& ray, std::span<const Crossing> crossings) const;

 private:
  struct Triangle {
    dvec3 corner[3];
    std::uint32_t number;
  };
  // The scene itself, or an instance.
  struct Part {
    std::uint32_t instance;
    std::vector<Triangle> triangles;  // in the scene
    const scene::Scene* mesh;         // whose spheres are met in its own space
    dmat3 linear{1}, inverse{1};
    dvec3 move{0}, place{0};
    double size = 0, condition = 1;
  };
  struct Met {
    bool possible = false, certain = false;
    double t = 0, error = 0;
  };

  void add_part(const scene::Scene& mesh, std::uint32_t instance, const dmat3& linear, const dvec3& move);
  double error_of(const Part& part, const dvec3& origin) const;
  template <class Take>
  void for_each_met(const Ray& ray, const Take& take) const;

  std::vector<Part> parts_;
  double reach_ = 0;  // the largest coordinate, about the scene's middle
  dvec3 middle_{0};
};

}  // namespace kdray::test
