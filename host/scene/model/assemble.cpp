// What    Instances as geometries, and scenes that are made of geometries.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <numeric>
#include <utility>

#include "base/error.h"
#include "scene/model/added_geometry.h"
#include "scene/model/check_scene.h"
#include "scene/model/first_fault.h"

namespace kdray::scene {

// ---- Instances of one prototype

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

// ---- A scene of geometries

namespace {

// Where a geometry's elements begin in the scene.
struct Offsets {
  std::size_t vertices, normals, triangles;
  std::uint32_t number, material;
};

template <class From, class To, class Changed>
void copy(const From& from, To& to, std::size_t first, const Changed& changed) {
  constexpr std::size_t kGrain = std::size_t{1} << 15;
  tbb::parallel_for(std::size_t{0}, (from.size() + kGrain - 1) / kGrain, [&](std::size_t grain) {
    for (std::size_t i = grain * kGrain; i < std::min(from.size(), (grain + 1) * kGrain); ++i)
      to[first + i] = changed(from[i], i);
  });
}

void put_vertices(Scene& scene, const AddedGeometry& geometry, const Offsets& at) {
  copy(geometry.vertices, scene.vertices, at.vertices, [](const dvec3& v, std::size_t) { return v; });
  copy(geometry.normals, scene.normals, at.normals, [](const vec3& n, std::size_t) { return n; });
}

void put_mesh(Scene& scene, const AddedGeometry& geometry, const Offsets& at) {
  put_vertices(scene, geometry, at);
  copy(geometry.triangles, scene.triangles, at.triangles, [&](Triangle t, std::size_t i) {
    for (std::uint32_t& v : t.vertex) v += static_cast<std::uint32_t>(at.vertices);
    for (std::uint32_t& n : t.normal)
      if (n != kNone) n += static_cast<std::uint32_t>(at.normals);
    t.material = at.material + geometry.material;
    t.number = at.number + static_cast<std::uint32_t>(i);
    return t;
  });
}

template <class Kind>
void put_shapes(Kind, Scene& scene, const AddedGeometry& geometry, const Offsets& at) {
  auto& shapes = Kind::of(scene);
  std::uint32_t number = at.number;
  for (auto shape : Kind::of(geometry)) {
    shape.material = at.material + geometry.material;
    shape.number = number++;
    shapes.push_back(shape);
  }
}

void put(Scene& scene, const AddedGeometry& geometry, const Offsets& at) {
  put_mesh(scene, geometry, at);
  primitives::for_each_shape([&](auto kind) { put_shapes(kind, scene, geometry, at); });
}

Offsets after(const Offsets& at, const AddedGeometry& geometry) {
  return {at.vertices + geometry.vertices.size(), at.normals + geometry.normals.size(),
          at.triangles + geometry.triangles.size(), at.number + geometry.primitive_count(), at.material};
}

// Indices into vertices have 32 bits, and numbers as well; references have 28 (check_scene.h).
void check_capacity(const Scene& scene, std::span<const AddedGeometry* const> geometries) {
  std::uint64_t n_vertices = scene.vertices.size(), n_primitives = scene.primitive_count();
  for (const AddedGeometry* const geometry : geometries) {
    n_vertices += geometry->vertices.size();
    n_primitives += geometry->primitive_count();
  }
  if (n_vertices >= kNone || n_primitives >= kMaxPrimitivesPerKind)
    throw Error(ErrorCode::input, fmt::format("{} vertices and {} primitives in one scene; split it",
                                              n_vertices, n_primitives));
}

void add_materials(Scene& scene, std::span<const AddedGeometry* const> geometries,
                   std::span<const Material> materials) {
  scene.materials.insert(scene.materials.end(), materials.begin(), materials.end());
  if (materials.empty() && !geometries.empty()) scene.materials.push_back(material_of({}));
}

}  // namespace

Scene mesh_of(const AddedGeometry& geometry, std::uint32_t first_material) {
  Scene mesh;
  mesh.name = geometry.name;
  mesh.vertices.resize(geometry.vertices.size());
  mesh.normals.resize(geometry.normals.size());
  mesh.triangles.resize(geometry.triangles.size());
  put(mesh, geometry, {0, 0, 0, 0, first_material});
  mesh.texturing.texcoords[0] = geometry.texcoords;
  return mesh;
}

void assemble(Scene& scene, std::span<const AddedGeometry* const> geometries,
              std::span<const Material> materials) {
  check_capacity(scene, geometries);
  Offsets at{scene.vertices.size(), scene.normals.size(), scene.triangles.size(), scene.primitive_count(),
             static_cast<std::uint32_t>(scene.materials.size())};
  add_materials(scene, geometries, materials);
  Offsets end = at;
  for (const AddedGeometry* const geometry : geometries) end = after(end, *geometry);
  scene.vertices.resize(end.vertices);
  scene.normals.resize(end.normals);
  scene.triangles.resize(end.triangles);
  for (const AddedGeometry* const geometry : geometries) {
    put(scene, *geometry, at);
    at = after(at, *geometry);
  }
}

void assemble_moved(Scene& scene, Scene&& before, std::span<const AddedGeometry* const> geometries,
                    std::span<const Material> materials) {
  add_materials(scene, geometries, materials);
  scene.vertices = std::move(before.vertices);
  scene.normals = std::move(before.normals);
  scene.triangles = std::move(before.triangles);
  primitives::for_each_shape(
      [&](auto kind) { decltype(kind)::of(scene) = std::move(decltype(kind)::of(before)); });
  Offsets at{scene.vertices.size(), scene.normals.size(), 0, 0, 0};  // the geometries' are the last ones
  for (const AddedGeometry* const geometry : geometries) {
    at.vertices -= geometry->vertices.size();
    at.normals -= geometry->normals.size();
  }
  for (const AddedGeometry* const geometry : geometries) {
    put_vertices(scene, *geometry, at);
    at = after(at, *geometry);
  }
}

}  // namespace kdray::scene
