#include "scene/model/scene.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

namespace kdray::scene {

namespace {

constexpr std::size_t kBoundsGrain = std::size_t{1} << 14;

// Only vertices that a triangle uses count: files often carry some that no face names. Used ones are marked
// first, since a mesh has six times as many corners as vertices.
std::vector<std::uint8_t> used_vertices(const Scene& scene) {
  std::vector<std::uint8_t> used(scene.vertices.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scene.triangles.size(), kBoundsGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i)
                        for (const std::uint32_t v : scene.triangles[i].vertex)
                          std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
                    });
  return used;
}

DBox triangle_bounds(const Scene& scene) {
  const std::vector<std::uint8_t> used = used_vertices(scene);
  const auto grow = [&](const tbb::blocked_range<std::size_t>& range, DBox box) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      if (used[i] != 0) box.grow(scene.vertices[i]);
    return box;
  };
  const auto join = [](DBox a, const DBox& b) {
    a.grow(b);
    return a;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, scene.vertices.size(), kBoundsGrain), DBox(),
                              grow, join);
}

}  // namespace

DBox Scene::bounds() const {
  DBox box = triangle_bounds(*this);
  primitives::for_each_shape([&](auto kind) {
    for (const auto& shape : decltype(kind)::of(*this)) box.grow(bounds_of(shape));
  });
  std::vector<DBox> of_meshes;
  for (const auto& mesh : meshes) of_meshes.push_back(mesh->bounds());
  for (const Instance& instance : instances) box.grow(bounds_of(instance, of_meshes[instance.mesh]));
  return box;
}

void set_disc(Light& light, const dvec3& normal, double radius) {
  const dvec3 a = glm::abs(normal);
  const dvec3 least = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0)
                      : a.y <= a.z             ? dvec3(0, 1, 0)
                                               : dvec3(0, 0, 1);
  const dvec3 across = glm::normalize(glm::cross(normal, least));
  light.kind = LightKind::disc;
  light.across = across * radius;
  light.down = glm::cross(normal, across) * radius;
}

std::uint32_t Scene::material_of(std::uint32_t number, std::uint32_t instance) const {
  if (instance != kNone) {
    if (instance >= instances.size()) return kNone;
    const Instance& placed = instances.data()[instance];
    return placed.material != kNone ? placed.material : meshes.at(placed.mesh)->material_of(number);
  }
  std::uint32_t material = kNone;
  primitives::for_each_kind([&](auto kind) {
    const auto& all = decltype(kind)::of(*this);
    const auto* const end = all.data() + all.size();
    const auto* const found = std::ranges::lower_bound(
        all.data(), end, number, {}, [](const auto& primitive) { return primitive.number; });
    if (found != end && found->number == number) material = found->material;
  });
  return material;
}

}  // namespace kdray::scene
