#include "accel/flatten/instances.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "accel/flatten/leaf_block.h"
#include "base/error.h"
#include "layout/wide.layout.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::flatten {

namespace {

constexpr int kLevels = 3;  // 8, 64, 512 parts

struct Child {
  Box box;
  layout::u32 word;
};

std::vector<Child> children_of(const WideForm& mesh, layout::u32 root) {
  const layout::WideNode& node = mesh.nodes[root];
  std::vector<Child> children;
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    const Box box = bounds_of_child(node, slot);
    if (!box.empty()) children.push_back({box, node.child[slot]});
  }
  return children;
}

// Returns the boxes of a node's children and their children: they cover all that is below it, and more
// tightly than its own box when turned.
std::vector<Box> boxes_below(const WideForm& mesh, layout::u32 root) {
  std::vector<Box> boxes;
  for (const Child& child : children_of(mesh, root)) {
    if (is_leaf(child.word)) {
      boxes.push_back(child.box);
      continue;
    }
    for (const Child& below : children_of(mesh, child.word)) boxes.push_back(below.box);
  }
  return boxes;
}

bool all_nodes(const std::vector<Child>& children) {
  return std::ranges::none_of(children, [](const Child& c) { return is_leaf(c.word); });
}

}  // namespace

std::vector<MeshPart> parts_of(const WideForm& mesh) {
  std::vector<MeshPart> parts{{boxes_below(mesh, 0)}};
  for (std::size_t level = 0, begin = 0; level < kLevels; ++level) {
    const std::size_t end = parts.size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::vector<Child> children = children_of(mesh, parts[i].root);
      if (!all_nodes(children)) continue;
      parts[i].first = static_cast<std::uint32_t>(parts.size());
      parts[i].n = static_cast<std::uint32_t>(children.size());
      for (const Child& child : children) parts.push_back({boxes_below(mesh, child.word), child.word});
    }
    begin = end;
  }
  return parts;
}

namespace {

constexpr double kRoundoff = 0x1p-24;
constexpr std::size_t kGrain = 4096;

// Takes what is in a mesh's space into the scene's.
struct Placing {
  dmat3 linear{1};
  dvec3 move{0};

  Placing(const scene::Instance& instance, const LocalSpace& mesh, const LocalSpace& scene)
      : linear(instance.linear * (scene.scale / mesh.scale)),
        move(scene.local(instance.point(mesh.center))) {}
  dvec3 point(const dvec3& p) const { return linear * p + move; }
};

void set_rows(float (&out)[3][3], const dmat3& m) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) out[row][column] = static_cast<float>(m[column][row]);
}

double reach_of(const Box& box) {
  return std::max(largest_component(dvec3(box.lo)), largest_component(dvec3(box.hi)));
}

dvec3 middle_of(const Box& box) {
  return (dvec3(box.lo) + dvec3(box.hi)) * 0.5;
}

// Returns the sums of the absolute values of a matrix's rows.
dvec3 row_sums(const dmat3& m) {
  return glm::abs(m[0]) + glm::abs(m[1]) + glm::abs(m[2]);
}

layout::Instance pack(const scene::Instance& from, const MeshForm& mesh, const Placing& placing) {
  layout::Instance out{};
  const dmat3 inverse = glm::inverse(placing.linear);
  const vec3 place(placing.point(middle_of(mesh.bounds)));
  set_rows(out.to_mesh, inverse);
  set_rows(out.to_world, placing.linear);
  primitives::set(out.place, place);
  primitives::set(out.mesh_place, vec3(inverse * (dvec3(place) - placing.move)));
  out.reach = static_cast<float>(reach_of(mesh.bounds));
  out.root = mesh.parts[0].root;
  out.material = from.material;
  return out;
}

// Returns whether all numbers, and the kernels' products of them, are within the range of float.
bool is_sound(const layout::Instance& instance) {
  constexpr float kMost = 0x1p60f;
  bool sound = true;
  float largest = 0;
  for (int row = 0; row < 3; ++row)
    for (int k = 0; k < 3; ++k) {
      sound =
          sound && std::abs(instance.to_mesh[row][k]) < kMost && std::abs(instance.to_world[row][k]) < kMost;
      largest = std::max(largest, std::abs(instance.to_world[row][k]));
    }
  for (int k = 0; k < 3; ++k)
    sound = sound && std::isfinite(instance.place[k]) && std::isfinite(instance.mesh_place[k]);
  return sound && largest > 1 / kMost;
}

Box widened(const DBox& box, const dvec3& by) {
  Box out;
  for (int k = 0; k < 3; ++k) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    out.lo[k] = std::nextafter(static_cast<float>(box.lo[k] - by[k]), -kInfinity);
    out.hi[k] = std::nextafter(static_cast<float>(box.hi[k] + by[k]), kInfinity);
  }
  return out;
}

Box bounds_of(const MeshPart& of, const MeshForm& mesh, const Placing& placing) {
  DBox box;
  for (const Box& part : of.boxes) {
    const dvec3 middle = placing.point(middle_of(part));
    const dvec3 half = (dvec3(part.hi) - dvec3(part.lo)) * 0.5;
    const dvec3 reach = glm::abs(placing.linear[0]) * half.x + glm::abs(placing.linear[1]) * half.y +
                        glm::abs(placing.linear[2]) * half.z;
    box.grow(middle - reach);
    box.grow(middle + reach);
  }
  return widened(box, row_sums(placing.linear) * (128 * kRoundoff * reach_of(mesh.bounds)));
}

// The least is what rotations with one scale need, so that instances that begin to turn need no other
// programs.
int widening_for(double condition) {
  int widen = 4;
  while (widen < condition * 42 / 32) widen *= 2;
  return widen;
}

}  // namespace

PlacedInstances place_instances(std::span<const scene::Instance> instances, std::span<const MeshForm> meshes,
                                const LocalSpace& scene) {
  PlacedInstances placed{
      Array<layout::Instance>(instances.size()), std::vector<Box>(instances.size()), {}, 1};
  std::atomic<int> widen = 1;
  std::atomic<std::size_t> unsound = instances.size();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, instances.size(), kGrain), [&](const auto& range) {
    double condition = 1;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const MeshForm& mesh = meshes[instances[i].mesh];
      const Placing placing(instances[i], mesh.space, scene);
      placed.instances[i] = pack(instances[i], mesh, placing);
      placed.instances[i].whole = static_cast<layout::u32>(i);
      placed.bounds[i] = bounds_of(mesh.parts[0], mesh, placing);
      condition = std::max(condition, scene::condition_of(placing.linear));
      std::size_t first = unsound;
      if (!is_sound(placed.instances[i]))
        while (i < first && !unsound.compare_exchange_weak(first, i)) continue;
    }
    int seen = widen;
    const int here = widening_for(std::min(condition, 2 * scene::kMostCondition));
    while (here > seen && !widen.compare_exchange_weak(seen, here)) continue;
  });
  if (unsound < instances.size())
    throw Error(
        ErrorCode::input,
        fmt::format(
            "instance {} of all in the scene is too small or too large beside the rest for single precision; "
            "leave out the one that is",
            unsound.load()));
  for (const Box& box : placed.bounds) placed.all.grow(box);
  placed.widen = widen;
  return placed;
}

Box bounds_of(const MeshPart& part, const scene::Instance& instance, const MeshForm& mesh,
              const LocalSpace& scene) {
  return bounds_of(part, mesh, Placing(instance, mesh.space, scene));
}

}  // namespace kdray::flatten
