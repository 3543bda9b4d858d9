// What    A scene with instances has the picture of the same scene with copies, but for single pixels at
//         edges; whatever walks, and in any scale. Of instances in one place the first is seen. What can't
//         follow instances refuses them in one line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "scene/model/check_scene.h"
#include "scene/model/instances.h"

namespace kdray::test {
namespace {

using scene::rotation, scene::scaling, scene::translation;

constexpr int kWidth = 160, kHeight = 120;

Picture rendered(const scene::Scene& model, Traversal traversal = Traversal::automatic, int depth = 5) {
  Renderer renderer(Scene{scene::Scene(model)}, {.binary_form = false}, device_of());
  RenderOptions options = exact_options(kWidth, kHeight, depth);
  options.traversal = traversal;
  return renderer.render(options);
}

scene::Scene with_copies(scene::Scene model) {
  scene::flatten_instances(model);
  return model;
}

// Pixels that differ by more than a hundredth, and the mean difference of all.
struct Difference {
  int pixels = 0;
  double mean = 0;
};

Difference between(const Picture& a, const Picture& b) {
  Difference d;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    double most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max<double>(most, std::abs(a.rgb[i + c] - b.rgb[i + c]));
    d.pixels += most > 0.01;
    d.mean += most / (kWidth * kHeight);
  }
  return d;
}

TEST(Instances, LookLikeCopies) {
  const scene::Scene model = instanced();
  scene::check_scene(model);
  const Picture kept = rendered(model), flat = rendered(with_copies(model));
  ASSERT_TRUE(all_finite(kept));
  ASSERT_GT(mean_luminance(kept), 0.05);
  const Difference d = between(kept, flat);
  EXPECT_LT(d.pixels, kWidth * kHeight / 200) << "of " << kWidth * kHeight;
  EXPECT_LT(d.mean, 1e-3);
}

// Tangents and footprints are found in the scene, mirrored and stretched as the mesh is there.
TEST(Instances, WithPicturesOfNormalsLookLikeCopies) {
  const scene::Scene model = instanced_maps();
  const Picture kept = rendered(model, Traversal::automatic, 2),
                flat = rendered(with_copies(model), Traversal::automatic, 2);
  ASSERT_TRUE(all_finite(kept));
  const Difference d = between(kept, flat);
  EXPECT_LT(d.pixels, kWidth * kHeight / 200) << "of " << kWidth * kHeight;
  EXPECT_LT(d.mean, 1e-3);
}

// Eye rays and their lights alone: nothing that reflects makes one edge many.
TEST(Instances, LookLikeCopiesToEyeRays) {
  const scene::Scene model = instanced();
  const Difference d = between(rendered(model, Traversal::automatic, 1),
                               rendered(with_copies(model), Traversal::automatic, 1));
  EXPECT_LT(d.pixels, kWidth * kHeight / 1000) << "of " << kWidth * kHeight;
}

TEST(Instances, LookTheSameToAllWalks) {
  const Picture first = rendered(instanced());
  for (const Traversal traversal : {Traversal::wide, Traversal::packet, Traversal::batch})
    EXPECT_TRUE(same_bits(first.rgb, rendered(instanced(), traversal).rgb)) << static_cast<int>(traversal);
}

TEST(Instances, LookTheSameAtAnySize) {
  const Picture first = rendered(instanced());
  EXPECT_TRUE(same_bits(first.rgb, rendered(moved(instanced(), 0x1p-30, dvec3(0))).rgb));
  EXPECT_TRUE(same_bits(first.rgb, rendered(moved(instanced(), 0x1p40, dvec3(0))).rgb));
  const Difference far = between(first, rendered(moved(instanced(), 1, {3e5, -1e5, 2e5})));
  EXPECT_LT(far.pixels, kWidth * kHeight / 200);
}

scene::Scene lone(const std::vector<std::pair<dmat4, std::uint32_t>>& places) {
  oracle::SceneBuilder b;
  b.background(vec3(0.1f)).camera({0, 1, 6}, {0, 0, 0}, 0.7).light({3, 5, 6}, vec3(0.8f));
  scene::Scene s = b.scene(), ball;
  add_smooth_ball(ball, {0, 0, 0}, 1, 8, oracle::matte({0.8f, 0.3f, 0.2f}));
  const std::uint32_t mesh = add_mesh(s, ball);
  s.materials.push_back(oracle::matte({0.1f, 0.9f, 0.2f}));
  s.materials.push_back(oracle::matte({0.2f, 0.3f, 0.9f}));
  for (const auto& [place, material] : places) add_instance(s, mesh, place, material);
  return s;
}

TEST(Instances, OneByItselfAndNone) {
  const scene::Scene one = lone({{rotation({0, 1, 0}, 0.3), scene::kNone}});
  EXPECT_LT(between(rendered(one), rendered(with_copies(one))).pixels, kWidth * kHeight / 1000);
  const Picture none = rendered(lone({}));
  for (const float v : none.rgb) ASSERT_EQ(v, 0.1f);
}

TEST(Instances, InOnePlaceTheFirstIsSeen) {
  const dmat4 place = rotation({0, 1, 0}, 0.3) * scaling({1, -0.9, 1.1});
  const Picture green = rendered(lone({{place, 1}})), blue = rendered(lone({{place, 2}}));
  ASSERT_FALSE(same_bits(green.rgb, blue.rgb));
  for (const Traversal traversal :
       {Traversal::automatic, Traversal::wide, Traversal::packet, Traversal::batch}) {
    EXPECT_TRUE(same_bits(green.rgb, rendered(lone({{place, 1}, {place, 2}, {place, 2}}), traversal).rgb));
    EXPECT_TRUE(same_bits(blue.rgb, rendered(lone({{place, 2}, {place, 1}, {place, 1}}), traversal).rgb));
  }
}

// So close, and of so many triangles, that they are opened: by walks, by parts, and against copies.
scene::Scene close_together() {
  scene::Scene s = lone({});
  scene::Scene ball;
  add_smooth_ball(ball, {0, 0, 0}, 1, 60, oracle::mirror({0.8f, 0.6f, 0.5f}));
  const std::uint32_t mesh = add_mesh(s, ball);
  for (int i = 0; i < 9; ++i)
    add_instance(s, mesh,
                 translation({i % 3 * 0.6 - 0.6, i / 3 * 0.6 - 0.6, i * 0.05}) * rotation({0, 1, 0}, i) *
                     scaling({i % 2 ? -0.5 : 0.5, 0.6, 0.4}));
  return s;
}

TEST(Instances, CloseTogetherLookTheSameToAllWalksAndInParts) {
  const scene::Scene model = close_together();
  const Scene scene{scene::Scene(model)};
  const Picture first = rendered(model);
  ASSERT_GT(mean_luminance(first), 0.05);
  EXPECT_LT(between(first, rendered(with_copies(model))).pixels, kWidth * kHeight / 200);
  for (const Traversal traversal : {Traversal::wide, Traversal::packet, Traversal::batch})
    EXPECT_TRUE(same_bits(first.rgb, rendered(model, traversal).rgb)) << static_cast<int>(traversal);
  for (const int queues : {1, 3}) {
    DeviceOptions device;
    device.queues = queues;
    Renderer renderer(scene, {.binary_form = false}, device_of(device));
    RenderOptions options = exact_options(kWidth, kHeight, 5);
    options.mode = Mode::odprt;
    EXPECT_TRUE(same_bits(first.rgb, renderer.render(options).rgb)) << queues << " queues";
  }
}

// A mirror image has its front where the original has it: glass bends light the same way.
TEST(Instances, MirroredTwiceIsTheSame) {
  const scene::Scene once = lone({{dmat4(1), scene::kNone}});
  const scene::Scene mirrored = lone({{scaling({-1, 1, 1}), scene::kNone}});
  EXPECT_LT(between(rendered(mirrored), rendered(with_copies(mirrored))).pixels, kWidth * kHeight / 1000);
  EXPECT_LT(between(rendered(once), rendered(mirrored)).pixels, kWidth * kHeight / 100);
}

TEST(Instances, HugeAndTinyOnesInOneScene) {
  scene::Scene s = lone({{translation({0, -1001, 0}) * scaling(dvec3(1000)), 1}, {dmat4(1), scene::kNone}});
  for (int i = 0; i < 30; ++i)
    add_instance(s, 0, translation({-1.5 + 0.1 * i, 0.4, 1.6}) * scaling(dvec3(0.03)), 2);
  const Difference d = between(rendered(s), rendered(with_copies(s)));
  EXPECT_LT(d.pixels, kWidth * kHeight / 200);
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

// The number that a primitive has among copies, which lie one after the other behind the scene's own.
class CopiedNumbers {
 public:
  explicit CopiedNumbers(const scene::Scene& model) {
    std::uint32_t first = model.primitive_count();
    for (const scene::Instance& i : model.instances) {
      first_.push_back(first);
      first += model.meshes[i.mesh]->primitive_count();
    }
  }
  float of(float instance, float primitive) const {
    return instance < 0 ? primitive
                        : static_cast<float>(first_[static_cast<std::size_t>(instance)]) + primitive;
  }

 private:
  std::vector<std::uint32_t> first_;
};

// One of an empty mesh comes first: it can't be hit, but has a place in the list.
TEST(Instances, HaveTheChannelsOfCopies) {
  scene::Scene model = instanced();
  scene::Instance empty = model.instances.front();
  empty.mesh = static_cast<std::uint32_t>(model.meshes.size());
  model.meshes.push_back(std::make_shared<const scene::Scene>());
  model.instances.insert(model.instances.begin(), empty);
  const auto seen = [](const scene::Scene& m) {
    Renderer renderer(Scene{scene::Scene(m)}, {}, device_of());
    RenderOptions options = exact_options(kWidth, kHeight);
    options.channels = {"depth", "normal", "primitive", "instance"};
    return renderer.render(options);
  };
  const Picture kept = seen(model), flat = seen(with_copies(model));
  const CopiedNumbers numbers(model);
  int others = 0, off = 0, in_instances = 0;
  for (std::size_t i = 0; i < std::size_t{kWidth} * kHeight; ++i) {
    EXPECT_EQ(channel(flat, "instance")[i], -1);
    const float instance = channel(kept, "instance")[i];
    in_instances += instance >= 0;
    if (numbers.of(instance, channel(kept, "primitive")[i]) != channel(flat, "primitive")[i]) {
      ++others;
      continue;
    }
    const float depth = channel(kept, "depth")[i], expected = channel(flat, "depth")[i];
    if (std::isinf(expected)) {
      EXPECT_EQ(depth, expected);
      continue;
    }
    off += std::abs(depth - expected) > 1e-4f * expected;
    for (const char* n : {"normal.x", "normal.y", "normal.z"})
      off += std::abs(channel(kept, n)[i] - channel(flat, n)[i]) > 1e-3f;
  }
  EXPECT_GT(in_instances, kWidth * kHeight / 10);
  EXPECT_LE(others, kWidth * kHeight / 200);  // at edges
  EXPECT_LE(off, kWidth * kHeight / 200);
}

TEST(Instances, AreRefusedWhereTheyAreNotKnown) {
  const Scene scene{instanced()};
  Renderer renderer(scene, {}, device_of());
  const auto refused = [&](const RenderOptions& options) {
    return refusal([&] { renderer.render(options); });
  };
  RenderOptions options = exact_options(16, 12);
  options.precision = Precision::float64;
  EXPECT_NE(refused(options).find("instances flat"), std::string::npos);
  options = exact_options(16, 12);
  options.traversal = Traversal::binary;
  EXPECT_NE(refused(options).find("instances flat"), std::string::npos);
  options = exact_options(16, 12);
  options.channels = {"cost"};
  EXPECT_NE(refused(options).find("instances flat"), std::string::npos);
  const Ray ray{{0, 0, 9}, 0, {0, 0, -1}, 100};
  for (const auto& [walk, precision] :
       {std::pair{Traversal::binary, Precision::float32}, {Traversal::automatic, Precision::float64}})
    EXPECT_NE(refusal([&] {
                renderer.trace(std::span(&ray, 1), false, 1, walk, precision);
              }).find("instances flat"),
              std::string::npos);
  EXPECT_FALSE(renderer.render(exact_options(16, 12)).rgb.empty());
}

TEST(Instances, OfTransformsThatHaveNoInverseAreRefused) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const auto& [place, fault] : {std::pair{scaling({1, 0, 1}), "flattens"},
                                     {scaling({1, 1e-20, 1}), "flattens"},
                                     {scaling({1, 1, 60}), "stretches"},
                                     {scaling({1, nan, 1}), "not finite"},
                                     {scaling({1, inf, 1}), "not finite"},
                                     {translation({inf, 0, 0}), "not finite"}}) {
    const scene::Scene s = lone({{dmat4(1), scene::kNone}, {place, scene::kNone}});
    const std::string said = refusal([&] { scene::check_scene(s); });
    EXPECT_NE(said.find("instance 1"), std::string::npos) << said;
    EXPECT_NE(said.find(fault), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace kdray::test
