// What    Affine transforms of scenes; and instances: meshes that lie in a scene many times and in memory
//         once. A mesh is a scene of its own, of primitives alone; its materials are those of the scene that
//         it is in.
// Shape   An instance's transform is affine, with an inverse: p in the mesh is linear*p + move in the world.
//         Importers keep as instances what pays (worth_keeping), and copy the rest, as they copy everything
//         where Instancing says so.
// Errors  fault_of() says in words why instances can't have a transform. apply_transform() throws
//         std::domain_error with what is wrong when a scene with shapes (spheres, ...) meets a transform that
//         would make ellipsoids of them; the caller knows the file and the place in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/box.h"
#include "base/vec.h"
#include "kdray/options.h"

namespace kdray::scene {

struct Scene;

struct Instance {
  dmat3 linear{1};
  dvec3 move{0};
  std::uint32_t mesh = 0;                // into Scene::meshes
  std::uint32_t material = 0xffffffffu;  // of all its primitives; none: each has its own

  dvec3 point(const dvec3& p) const { return linear * p + move; }
};

Instance instance_of(const dmat4& to_world, std::uint32_t mesh);

// Returns the largest ratio of what a transform does to two directions, bounded: |linear| times |inverse|,
// where |m| is the largest sum of a row's absolute values. At least 1, infinite for a flat transform. A
// rotation with one scale has 3 at most.
double condition_of(const dmat3& linear);

// Beyond this the rounding of a ray on its way into the mesh is too large a share of the scene.
inline constexpr double kMostCondition = 48;

// The most instances that the word of a wide node's child can number.
inline constexpr std::size_t kMaxInstances = std::size_t{1} << 27;

// Returns what is wrong with a transform; null where nothing is.
const char* fault_of(const Instance& instance);

// Returns bounds that contain the mesh's, moved.
DBox bounds_of(const Instance& instance, const DBox& mesh);

// Returns whether so many copies of a mesh take so much more memory than it does that they should be
// instances. What is small is copied: rays go through one tree faster than through two.
bool worth_keeping(std::uint64_t primitives, std::uint64_t copies);

// Adds a copy of a mesh, which is not one of `scene`'s instances, to its triangles and shapes. Throws
// std::domain_error where shapes would no longer be shapes of their kind.
void add_copy(const Scene& mesh, const Instance& instance, Scene& scene);

// Where a scene's primitives are copies of its meshes: of each instance the number of its first, and one
// behind the last; and of each whether it mirrors, so that triangles' second and third corners have changed
// places. Empty where there are none.
struct Copies {
  std::vector<std::uint32_t> first;
  std::vector<std::uint8_t> is_mirrored;

  std::size_t size() const { return is_mirrored.size(); }
};

// Copies all instances into the scene's primitives, behind those that there are. Throws ErrorCode::input
// where they become too many, or a sphere an ellipsoid.
Copies flatten_instances(Scene& scene);

// While one lives, importers of its thread do as it says.
class Instancing {
 public:
  explicit Instancing(Instances how);
  ~Instancing();
  Instancing(const Instancing&) = delete;
  Instancing& operator=(const Instancing&) = delete;
  static Instances how();

 private:
  Instances outer_;
};

// Moves vertices, normals and shapes. Normals stay perpendicular to their surface (inverse transpose)
// and of unit length; a mirroring transform turns the triangles over, so that their front stays where the
// normals point.
void apply_transform(const dmat4& m, Scene& scene);

dmat4 translation(const dvec3& by);
dmat4 scaling(const dvec3& by);
dmat4 rotation(const dvec3& unit_axis, double radians);  // right-handed

}  // namespace kdray::scene
