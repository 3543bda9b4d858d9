// What    Embree sees the scene that kdray sees, every kind of primitive, in every mode. Skipped without
//         Embree.
#include "bench/embree/embree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <type_traits>

#include "api/statistics_json.h"
#include "apps/cli/program.h"
#include "bench/embree/embree.h"
#include "bench/race/compare.h"
#include "bench/workload/scenes.h"
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
  if (embree_versions().empty()) GTEST_SKIP() << "no Embree is found";
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
  if (embree_versions().empty()) GTEST_SKIP() << "no Embree is found";
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
  if (embree_versions().empty()) GTEST_SKIP() << "no Embree is found";
  EXPECT_THROW(make_embree_scenes(scene), Error) << "Embree has no " << TypeParam::kNames;
}

// Frames of SPD's scenes by Embree are kdray's, but for pixels at edges.
class EmbreeFramesOf : public testing::TestWithParam<const char*> {};

TEST_P(EmbreeFramesOf, AreKdraysPictures) {
  if (embree_versions().empty()) GTEST_SKIP() << "no Embree is found";
  KDRAY_NEED_DEVICE();
  RenderOptions options;
  options.width = 150, options.height = 100, options.depth = 4;  // no whole number of tiles
  const Scene scene(generate::load_scene(GetParam()));
  Renderer renderer(scene);
  const Picture picture = renderer.render(options);
  // Embree traces those too that kdray knows to meet nothing.
  const nlohmann::json rays = api::statistics_json(renderer.statistics()).at("rays"),
                       skipped = rays.at("skipped");
  const double n_rays = rays.at("total").get<double>() + skipped.at("light_in_the_open").get<double>() +
                        skipped.at("of_the_background").get<double>();
  for (const EmbreeFrames& frames : embree_frames(
           scene.model(),
           {options.width, options.height, options.depth, renderer.statistics().frame->spawn_threshold, 2})) {
    const EmbreePicture other = frames.render();
    ASSERT_EQ(other.rgb.size(), picture.rgb.size() / 3);
    std::size_t n_other = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); ++i)
      n_other += std::abs(other.rgb[i / 3][static_cast<int>(i % 3)] - picture.rgb[i]) > 0.02f;
    EXPECT_LE(n_other, picture.rgb.size() / 50) << frames.name;
    EXPECT_NEAR(static_cast<double>(other.n_rays), n_rays, 0.02 * n_rays) << frames.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, EmbreeFramesOf,
                         testing::Values("balls", "gears", "mount", "rings", "teapot", "tetra", "tree"),
                         [](const auto& info) { return std::string(info.param); });

INSTANTIATE_TEST_SUITE_P(Scenes, SeesTheSame, testing::Values("tetra", "balls", "rings", "tree"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace kdray::bench
