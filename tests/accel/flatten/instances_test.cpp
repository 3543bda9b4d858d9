// What    What instances promise (host/accel/flatten/instances.h), against double: how far the ray in a mesh
//         is off, that boxes hold what is hit, at any origin, and that the tree over instances holds them
//         all, in boxes.
#include "accel/flatten/instances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "accel/flatten/instance_openings.h"
#include "base/local_space.h"
#include "scene/model/instances.h"

namespace kdray::flatten {
namespace {

constexpr double kU = 0x1p-24;

class Random {
 public:
  explicit Random(unsigned seed) : bits_(seed) {}
  double in(double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(bits_); }
  dvec3 vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  dvec3 direction() {
    for (;;)
      if (const dvec3 v = vector(1); glm::length(v) > 0.1 && glm::length(v) < 1) return glm::normalize(v);
  }
  double power(double lo, double hi) { return std::exp2(in(lo, hi)); }

 private:
  std::mt19937 bits_;
};

// A transform with an inverse; stretched up to the limit.
scene::Instance any_instance(Random& random) {
  for (;;) {
    const double size = random.power(-14, 3);
    dvec3 scale{random.power(-1.5, 1.5), random.power(-1.5, 1.5), random.power(-1.5, 1.5)};
    if (random.in(0, 1) < 0.5) scale.x = -scale.x;
    const dmat4 m = scene::translation(random.vector(1000)) *
                    scene::rotation(random.direction(), random.in(0, 6)) * scene::scaling(scale * size) *
                    scene::rotation(random.direction(), random.in(0, 6));
    const scene::Instance instance = scene::instance_of(m, 0);
    if (!scene::fault_of(instance)) return instance;
  }
}

// The kernels' sum, as kernels/traverse/instance.clh has it.
float along(const float (&row)[3], const vec3& v, float w) {
  return std::fma(row[0], v[0], std::fma(row[1], v[1], std::fma(row[2], v[2], w)));
}
vec3 by_rows(const float (&rows)[3][3], const vec3& v, const vec3& w) {
  return {along(rows[0], v, w[0]), along(rows[1], v, w[1]), along(rows[2], v, w[2])};
}

struct Case {
  LocalSpace mesh_space{{0.3, -0.2, 5}, 0x1p9}, scene_space{{10, 20, -5}, 0x1p-1};
  scene::Instance instance;
  MeshForm mesh{mesh_space, Box{vec3(-700, -1500, 3), vec3(900, -100, 1800)}, {}};
  PlacedInstances placed;

  explicit Case(Random& random) : instance(any_instance(random)) {
    mesh.parts = {{{mesh.bounds}}};
    placed = place_instances(std::span(&instance, 1), std::span(&mesh, 1), scene_space);
  }
  // From the mesh's space to the scene's, without rounding to float.
  dvec3 in_scene(const dvec3& p) const { return scene_space.local(instance.point(mesh_space.world(p))); }
  dmat3 linear() const { return instance.linear * (scene_space.scale / mesh_space.scale); }
  dvec3 in_mesh(const dvec3& p) const {
    return mesh_space.local(glm::inverse(instance.linear) * (scene_space.world(p) - instance.move));
  }
};

dvec3 absolute_product(const float (&rows)[3][3], const dvec3& v) {
  dvec3 sum(0);
  for (int row = 0; row < 3; ++row)
    for (int k = 0; k < 3; ++k) sum[row] += std::abs(static_cast<double>(rows[row][k])) * std::abs(v[k]);
  return sum;
}

TEST(Instances, TheRayInTheMeshIsOffByItsBound) {
  Random random(28);
  for (int i = 0; i < 20000; ++i) {
    const Case c(random);
    const layout::Instance& at = c.placed.instances[0];
    const vec3 place(at.place[0], at.place[1], at.place[2]),
        there(at.mesh_place[0], at.mesh_place[1], at.mesh_place[2]);
    const vec3 o(dvec3(place) + random.direction() * random.power(-20, 14)), d(random.direction());
    const vec3 o_mesh = by_rows(at.to_mesh, o - place, there), d_mesh = by_rows(at.to_mesh, d, vec3(0));
    const dvec3 o_exact = c.in_mesh(dvec3(o)), d_exact = glm::inverse(c.linear()) * dvec3(d);
    const dvec3 o_bound =
        6 * kU * (absolute_product(at.to_mesh, dvec3(o) - dvec3(place)) + glm::abs(dvec3(there)));
    const dvec3 d_bound = 4 * kU * absolute_product(at.to_mesh, dvec3(d));
    for (int k = 0; k < 3; ++k) {
      ASSERT_LE(std::abs(o_mesh[k] - o_exact[k]), o_bound[k] * (1 + 1e-6)) << i;
      ASSERT_LE(std::abs(d_mesh[k] - d_exact[k]), d_bound[k] * (1 + 1e-6)) << i;
    }
  }
}

// A ray to a point of the mesh, as its instance has the ray: where that passes the point is in the instance's
// box, by what boxes are widened by on the way.
TEST(Instances, BoxesHoldWhatIsHit) {
  Random random(29);
  for (int i = 0; i < 20000; ++i) {
    const Case c(random);
    const layout::Instance& at = c.placed.instances[0];
    const vec3 place(at.place[0], at.place[1], at.place[2]),
        there(at.mesh_place[0], at.mesh_place[1], at.mesh_place[2]);
    const dvec3 lo(c.mesh.bounds.lo), hi(c.mesh.bounds.hi);
    dvec3 target{random.in(lo.x, hi.x), random.in(lo.y, hi.y), random.in(lo.z, hi.z)};
    target[static_cast<int>(random.in(0, 2.99))] = random.in(0, 1) < 0.5 ? lo[i % 3] : hi[i % 3];
    target = glm::clamp(target, lo, hi);
    const dvec3 from = c.in_scene(target) + random.direction() * random.power(-16, 16);
    const vec3 o(from), d(glm::normalize(c.in_scene(target) - dvec3(o)));
    // Aimed in the mesh: t where its ray is nearest to the target, which it passes by as its direction was
    // rounded.
    const dvec3 o_mesh(by_rows(at.to_mesh, o - place, there)), d_mesh(by_rows(at.to_mesh, d, vec3(0)));
    const double t = glm::dot(target - o_mesh, d_mesh) / glm::dot(d_mesh, d_mesh);
    const dvec3 hit = glm::clamp(o_mesh + t * d_mesh, lo, hi), miss = o_mesh + t * d_mesh - hit;
    const double reach = std::max(largest_component(o_mesh), double{at.reach});
    if (largest_component(miss) > 13 * kU * reach) continue;  // it isn't hit
    const dvec3 point = dvec3(o) + t * dvec3(d);
    const double pad = c.placed.widen * 0x1p-19 * (largest_component(dvec3(o)) + 2048);
    for (int k = 0; k < 3; ++k) {
      ASSERT_GE(point[k], c.placed.bounds[0].lo[k] - pad) << i;
      ASSERT_LE(point[k], c.placed.bounds[0].hi[k] + pad) << i;
    }
  }
}

TEST(Instances, WideningFollowsTheCondition) {
  MeshForm mesh{{}, Box{vec3(-1000), vec3(1000)}, {{{Box{vec3(-1000), vec3(1000)}}}}};
  const auto widen_of = [&](const dmat4& m) {
    const scene::Instance instance = scene::instance_of(m, 0);
    return place_instances(std::span(&instance, 1), std::span(&mesh, 1), {}).widen;
  };
  EXPECT_EQ(widen_of(dmat4(1)), 4);
  EXPECT_EQ(widen_of(scene::rotation(glm::normalize(dvec3(1, 2, 3)), 1)), 4);
  EXPECT_EQ(widen_of(scene::scaling({1, 1, 48})), 64);
}

// Each instance is met once, in boxes that hold it; stacks are as deep as said.
void check(const InstanceTree& tree, std::span<const Box> boxes) {
  std::vector<int> met(boxes.size(), 0);
  const auto visit = [&](auto&& self, std::size_t node, const Box& around) -> void {
    const layout::WideNode& n = tree.nodes.at(node);
    for (std::size_t slot = 0; slot < 8; ++slot) {
      Box box;
      for (int k = 0; k < 3; ++k) box.lo[k] = n.bounds[k][0][slot], box.hi[k] = n.bounds[k][1][slot];
      if (box.empty()) continue;
      EXPECT_TRUE(around.contains(box));
      const layout::u32 child = n.child[slot];
      if ((child & KDRAY_INSTANCE_LEAF) == KDRAY_INSTANCE_LEAF) {
        const std::size_t index = child & KDRAY_WIDE_FIRST_MASK;
        ASSERT_LT(index, boxes.size());
        ++met[index];
        EXPECT_TRUE(box.contains(boxes[index]));
      } else {
        self(self, child, box);
      }
    }
  };
  visit(visit, 0, Box{vec3(-1e30f), vec3(1e30f)});
  for (const int n : met) ASSERT_EQ(n, 1);
}

TEST(InstanceTree, HoldsEachInstanceOnce) {
  Random random(30);
  for (const std::size_t n : {1u, 2u, 8u, 9u, 100u, 5000u}) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < n; ++i) {
      const vec3 at(random.vector(1000)), size(random.direction() * 50.0);
      boxes.push_back({at - glm::abs(size), at + glm::abs(size)});
    }
    const InstanceTree tree = build_instance_tree(boxes);
    check(tree, boxes);
    EXPECT_LE(tree.nodes.size(), n);
    EXPECT_EQ(tree.nodes.size(), build_instance_tree(boxes).nodes.size());
  }
}

TEST(InstanceTree, PartsWhatLiesInOnePlace) {
  const std::vector<Box> same(3000, Box{vec3(1), vec3(2)});
  const InstanceTree tree = build_instance_tree(same);
  check(tree, same);
  EXPECT_LT(*std::max_element(tree.needs.begin(), tree.needs.end()), 60);
  std::vector<Box> growing;
  for (int i = 0; i < 100; ++i)
    growing.push_back({vec3(std::exp2(float(i))), vec3(1.1f * std::exp2(float(i)))});
  check(build_instance_tree(growing), growing);
}

}  // namespace
}  // namespace kdray::flatten
