// What    Closed meshes whose edges are shared by index, and points that are surely inside of them.
// Why     Vertices shared by index are rounded to float once, together: whatever rounding moves, an edge
//         stays one edge and the mesh stays closed. A mesh whose triangles bring their own corners would open
//         where equal corners round apart.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "accel/prepare/prepared.h"
#include "base/vec.h"
#include "kdray/kdray.h"
#include "scene/model/scene.h"
#include "stress/random.h"

namespace kdray::stress {

struct NamedMesh {
  std::string name;
  scene::Scene scene;
};

scene::Scene cube();          // 12 triangles; splitting planes and faces coincide
scene::Scene ball(int rows);  // rows x 2*rows patches on the unit sphere
scene::Scene
needle();  // a spindle, a hundred times as long as thick, of slivers a thousand times as long as wide
scene::Scene
crumpled();  // a ball whose radius changes from vertex to vertex by up to 3: star-shaped, all edges sharp
std::vector<NamedMesh> small_closed_meshes();

// A file's mesh with equal vertices merged; no scene where an edge is not shared by exactly two triangles.
bool is_closed(const scene::Scene& scene);

// The scene scaled about the origin, then moved.
scene::Scene placed(scene::Scene scene, double scale, const dvec3& offset);

// A closed mesh as the kernels see it, its renderer, and how world and kernel coordinates go together.
class ClosedMesh {
 public:
  explicit ClosedMesh(scene::Scene scene);

  Renderer& renderer() { return renderer_; }
  std::size_t triangles() const { return prepared_.prepared().flat.triangles.size(); }
  dvec3 corner(std::size_t triangle, int k) const;  // exactly, in the kernels' coordinates
  dvec3 lo() const { return lo_; }
  dvec3 hi() const { return hi_; }

  struct Plane {
    int axis;
    float at;
  };
  const std::vector<Plane>& planes() const { return planes_; }  // the tree's

  // The ray's origin in the world nearest to a point in the kernels' coordinates, and where the kernels then
  // see it: exactly, or the point is of no use and the result false.
  bool to_world(const dvec3& local, vec3* world, dvec3* seen) const;

  // By its winding number about the mesh as the kernels see it: 1 inside, 0 outside, a part of 1 on the
  // surface.
  bool is_inside(const dvec3& point) const;

 private:
  PreparedScene prepared_;
  Renderer renderer_;
  LocalSpace space_;
  dvec3 lo_, hi_;
  std::vector<Plane> planes_;
};

// Origins inside of a mesh, checked once and drawn from often.
struct Origin {
  vec3 world;
  dvec3 local;
  int axis = 0;  // of the plane it lies on, where it was asked to lie on one
};
// `n` of what `propose` proposes (in kernel coordinates) and is inside; fewer where few are.
std::vector<Origin> origins_inside(const ClosedMesh& mesh, std::uint64_t seed, std::size_t n,
                                   const std::function<dvec3(Random&, int* axis)>& propose);

}  // namespace kdray::stress
