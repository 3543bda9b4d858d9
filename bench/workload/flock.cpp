// What    Many of one mesh, side by side in a square (workload/scenes.h).

#include <algorithm>
#include <memory>
#include <numbers>

#include "base/error.h"
#include "bench/workload/scenes.h"
#include "scene/generate/rotation.h"
#include "scene/model/frame.h"
#include "scene/model/instances.h"

namespace kdray::bench {

namespace {

// A turn that comes near no turn before it for long: of the golden angle.
double turn_of(int number) {
  return number * std::numbers::pi * (3 - 2.23606797749979);
}

std::shared_ptr<scene::Scene> triangles_of(const scene::Scene& from) {
  auto mesh = std::make_shared<scene::Scene>();
  mesh->name = from.name;
  mesh->vertices = from.vertices;
  for (scene::Triangle t : from.triangles) {
    t.material = 0;
    std::ranges::fill(t.normal, scene::kNone);
    t.number = static_cast<std::uint32_t>(mesh->triangles.size());
    mesh->triangles.push_back(t);
  }
  return mesh;
}

}  // namespace

scene::Scene flock_of(const scene::Scene& mesh, int across, double apart) {
  if (mesh.triangles.empty())
    throw Error(ErrorCode::input, mesh.name + ": no triangles to make instances of");
  scene::Scene flock;
  flock.name = mesh.name;
  flock.materials.emplace_back();
  flock.materials[0].diffuse = vec3(0.7f);
  flock.meshes.push_back(triangles_of(mesh));
  const DBox box = flock.meshes[0]->bounds();
  const dvec3 middle = (box.lo + box.hi) * 0.5, extent = box.extent();
  const double step = apart * std::max({extent.x, extent.y, extent.z});
  for (int i = 0; i < across * across; ++i) {
    dmat3 linear = generate::rotation_y(turn_of(i));
    if (i % 2 == 1) linear[0] = -linear[0];
    scene::Instance instance;
    instance.linear = linear;
    instance.move = dvec3(i % across * step, 0, i / across * step) - linear * middle;
    flock.instances.push_back(instance);
  }
  scene::frame_scene(flock);
  return flock;
}

}  // namespace kdray::bench
