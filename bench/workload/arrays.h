// What    What `kdray bench queries` hands to both sides: a mesh, and rays and points, as arrays of floats in
//         memory.
// Shape   Three floats to a vertex, an origin, a direction or a point; directions have unit length.
// Errors  ErrorCode::input for a scene without triangles.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/workload/rays.h"

namespace kdray::bench {

struct MeshArrays {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;

  std::size_t n_triangles() const { return triangles.size() / 3; }
};

// The scene's triangles, in its order; what else it has is left out.
MeshArrays mesh_of(const scene::Scene& scene, const std::string& name);

// As many points as rays: where questions about points are asked from.
struct QuerySet {
  std::string name;
  std::vector<float> origins, directions, points;

  std::size_t size() const { return origins.size() / 3; }
  std::vector<Ray> structs() const;
};

// coherent, diffuse, random.
std::span<const std::string_view> set_names();

// The sets of these names, of n rays each; `trace` finds the closest hits on the mesh. Rays are those of the
// classes `primary`, `diffuse` and `random` (workload/rays.h), repeated where there are fewer; a set of which
// the scene has no rays at all is left out. The points of `coherent` lie half way to what the rays hit (or as
// far ahead as the scene is wide), those of `diffuse` by the surfaces, those of `random` anywhere in the
// bounds.
std::vector<QuerySet> make_sets(const scene::Scene& scene, std::span<const std::string> names, std::size_t n,
                                const Tracer& trace);

}  // namespace kdray::bench
