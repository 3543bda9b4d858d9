#include "scene/model/added_instances.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "scene/model/first_fault.h"

namespace kdray::scene {

namespace {

Instance placed(const std::array<double, 12>& rows) {
  Instance instance;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      instance.linear[column][row] = rows[static_cast<std::size_t>(4 * row + column)];
    instance.move[row] = rows[static_cast<std::size_t>(4 * row + 3)];
  }
  return instance;
}

// The materials stay as they are in `instances`.
void place(const Transforms& transforms, PageVector<Instance>& instances) {
  const std::size_t bad = first_fault(transforms.size(), [&](std::size_t i) {
    const Instance here = placed(transforms[i]);
    instances[i].linear = here.linear;
    instances[i].move = here.move;
    return fault_of(here) == nullptr;
  });
  if (bad < transforms.size())
    throw Error(ErrorCode::input, fmt::format("transforms[{}]: {}", bad, fault_of(placed(transforms[bad]))));
}

}  // namespace

AddedGeometry make_added(GeometryId prototype, const Transforms& transforms, const Words& materials,
                         std::size_t n_materials) {
  const std::size_t n = transforms.size();
  if (n >= kMaxInstances) throw Error(ErrorCode::input, "transforms: 2^27 of them or more; split the scene");
  if (materials.size() > 1 && materials.size() != n)
    throw Error(ErrorCode::input,
                fmt::format("materials: {} of them for {} instances; give one for each, or one",
                            materials.size(), n));
  AddedGeometry geometry;
  geometry.of = prototype;
  geometry.instances.resize(n);
  place(transforms, geometry.instances);
  if (materials.empty()) return geometry;
  const std::size_t bad = first_fault(n, [&](std::size_t i) {
    std::uint32_t& material = geometry.instances[i].material;
    material = materials[materials.size() == 1 ? 0 : i][0];
    return material == kOwnMaterial || material < n_materials;
  });
  if (bad < n)
    throw Error(ErrorCode::usage, fmt::format("materials[{}]: there is no material {}; add it first", bad,
                                              geometry.instances[bad].material));
  return geometry;
}

void move_instances(AddedGeometry& geometry, const Transforms& transforms) {
  if (!geometry.is_instances())
    throw Error(ErrorCode::usage, "only instances have transforms that can be changed");
  if (transforms.size() != geometry.instances.size())
    throw Error(ErrorCode::input, fmt::format("transforms: {} of them; there are {} instances",
                                              transforms.size(), geometry.instances.size()));
  PageVector<Instance> moved = geometry.instances;
  place(transforms, moved);
  geometry.instances = std::move(moved);
}

void put_instances(Scene& scene, const AddedGeometry& geometry, std::uint32_t mesh,
                   std::uint32_t first_material) {
  static_assert(kOwnMaterial == kNone);
  const std::size_t first = scene.instances.size();
  scene.instances.resize(first + geometry.instances.size());
  tbb::parallel_for(std::size_t{0}, geometry.instances.size(), [&](std::size_t i) {
    Instance& instance = scene.instances[first + i];
    instance = geometry.instances[i];
    instance.mesh = mesh;
    if (instance.material != kNone) instance.material += first_material;
  });
}

}  // namespace kdray::scene
