// What    Embree sees the scene that kdray sees, every kind of primitive, in every mode. Skipped without
//         Embree.
#include "bench/embree/embree.h"

#include <gtest/gtest.h>

#include <numeric>
#include <type_traits>

#include "apps/cli/program.h"
#include "bench/race/compare_hits.h"
#include "bench/workload/flock.h"
#include "conformance/all_kinds.h"
#include "scene/generate/built_in.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/model/instances.h"

namespace kdray::bench {
namespace {

// 33 x 33 rays: no whole number of packets or streams.
std::vector<RayClass> classes_of(const scene::Scene& scene, Renderer& renderer) {
  const std::vector<std::string> names(class_names().begin(), class_names().end());
  return make_classes(scene, names, 33, [&](std::span<const Ray> rays) {
    return renderer.trace(rays, false, 1, Traversal::binary);
  });
}

void expect_to_see_the_same(scene::Scene model) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  KDRAY_NEED_DEVICE();
  const Scene scene(std::move(model));
  Renderer renderer(scene);
  const auto scenes = make_embree_scenes(scene.model());
  for (const RayClass& c : classes_of(scene.model(), renderer)) {
    const std::vector<Hit> wanted = renderer.trace(c.rays, c.any_hit, 1, Traversal::binary);
    for (const Contestant& contestant : embree_contestants(scenes, 2))
      for (const Variant& v : contestant.variants) {
        const Traced traced = v.trace(c);
        ASSERT_EQ(traced.hits.size(), c.rays.size());
        // The fast mode loses rays at edges and corners.
        EXPECT_LE(differing_share(wanted, traced.hits), 5e-3)
            << c.name << " " << contestant.mode << " " << v.name;
      }
  }
}

// Instances, against kdray's, and against Embree's own of the copies.
TEST(EmbreeScenes, SeeInstances) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  KDRAY_NEED_DEVICE();
  scene::Scene model = flock_of(generate::displaced_sphere(20), 3, 0.6);
  const Scene kept{scene::Scene(model)};
  scene::flatten_instances(model);
  const Scene flat(std::move(model));
  Renderer renderer(kept, {.binary_form = false}), of_copies(flat);
  const auto scenes = make_embree_scenes(kept.model());
  for (const RayClass& c : classes_of(flat.model(), of_copies)) {
    const std::vector<Hit> wanted = renderer.trace(c.rays, c.any_hit, 1, Traversal::wide);
    EXPECT_LE(differing_distances(wanted, of_copies.trace(c.rays, c.any_hit, 1, Traversal::wide)), 1e-2);
    for (const Contestant& contestant : embree_contestants(scenes, 2))
      for (const Variant& v : contestant.variants) {
        const std::vector<Hit> hits = v.trace(c).hits;
        ASSERT_EQ(hits.size(), c.rays.size());
        EXPECT_LE(differing_share(wanted, hits), 5e-3) << c.name << " " << contestant.mode << " " << v.name;
        if (c.any_hit) continue;
        std::size_t n_same = 0;
        for (std::size_t i = 0; i < hits.size(); ++i) n_same += hits[i].primitive == wanted[i].primitive;
        EXPECT_GE(n_same, hits.size() * 97 / 100) << c.name << " " << contestant.mode;
      }
  }
}

class SeesTheSame : public testing::TestWithParam<const char*> {};

TEST_P(SeesTheSame, InEveryMode) {
  expect_to_see_the_same(generate::load_scene(GetParam()));
}

template <class Kind>
class SeesTheSameOf : public testing::Test {};
TYPED_TEST_SUITE(SeesTheSameOf, test::AllKinds, test::KindNames);

template <class Kind, class... Kinds>
constexpr bool kIsOneOf = (std::is_same_v<Kind, Kinds> || ...);

TYPED_TEST(SeesTheSameOf, InEveryMode) {
  const scene::Scene scene = test::scene_of<TypeParam>(60, 20261124);
  if (kIsOneOf<TypeParam, primitives::TriangleKind, primitives::SphereKind, primitives::ConeKind,
               primitives::DiscKind>)
    return expect_to_see_the_same(scene);
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  EXPECT_THROW(make_embree_scenes(scene), Error) << "Embree has no " << TypeParam::kNames;
}

INSTANTIATE_TEST_SUITE_P(Scenes, SeesTheSame, testing::Values("tetra", "balls", "rings", "tree"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace kdray::bench
