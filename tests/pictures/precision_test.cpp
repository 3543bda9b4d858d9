// What    --precision double against the independent ray tracer, which sees the scene as it is stored:
//         pictures to the last place of their floats, hits as well. And float against double: how far
//         rounding moves a picture, with the pixels that hang on a hair told apart.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "oracle/build_scene.h"
#include "oracle/oracle.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "pictures/stored.h"
#include "scene/generate/generate.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray::test {
namespace {

class Precision64 : public EachDevice {
  void SetUp() override {
    if (!computes_in_double(GetParam()))
      GTEST_SKIP() << "device " << GetParam() << " does not compute in double";
  }
};

RenderOptions in_double(RenderOptions o) {
  o.precision = Precision::float64;
  return o;
}

// Nothing is cut off that a picture's floats could show.
RenderOptions everything(int size) {
  RenderOptions o = exact_options(size, size);
  o.min_weight = 1e-13;
  return o;
}

struct Apart {
  double worst = 0, rmse = 0;  // of the pixels that are no edges; beyond the rounding of the picture's floats
  int edges = 0, differing_edges = 0;
};

// A pixel is a float, which may be off by half an ulp.
double beyond_rounding(float found, double wanted) {
  return std::max(0.0, std::abs(found - wanted) - 0x1p-24 * std::abs(wanted));
}

Apart compare(const Picture& picture, const oracle::OracleResult& truth, double tolerance) {
  Apart apart;
  double sum = 0;
  for (std::size_t i = 0; i < truth.rgb.size(); ++i) {
    double worst = 0, square = 0;
    for (int c = 0; c < 3; ++c) {
      const double d = beyond_rounding(picture.rgb[3 * i + c], truth.rgb[i][c]);
      worst = std::max(worst, d), square += d * d;
    }
    apart.edges += truth.edge[i];
    apart.differing_edges += truth.edge[i] && worst > tolerance;
    if (truth.edge[i]) continue;
    apart.worst = std::max(apart.worst, worst);
    sum += square;
  }
  apart.rmse = std::sqrt(sum / (3.0 * static_cast<double>(truth.rgb.size())));
  return apart;
}

// Measured on these scenes: nothing beyond the rounding of the picture, but for one pixel each of 7e-9 and
// 8e-8 where rays graze cones (the root of 2^-53 is 1e-8). Float: RMSE 9e-9 to 2e-7.
TEST_P(Precision64, PicturesAreTheOraclesToTheLastPlace) {
  constexpr int kSize = 64;
  for (const NamedScene& named : small_scenes()) {
    SCOPED_TRACE(named.name);
    if (named.name == "scaled_down" || named.name == "scaled_up" || named.name == "far_away") continue;
    scene::Scene model = named.make();
    const double hither = model.camera->hither;
    model.camera = straight_camera(0.25, 6);
    model.camera->hither = hither > 0 ? 5.5 : 0;
    const oracle::OracleResult truth = oracle::trace_picture(as_stored(model).model, kSize, kSize, 5);
    Renderer renderer{Scene(std::move(model)), {}, {.device = GetParam()}};
    const Apart apart = compare(renderer.render(in_double(everything(kSize))), truth, 1e-9);
    const Apart in_float = compare(renderer.render(everything(kSize)), truth, 1e-9);
    RecordProperty(named.name,
                   fmt::format("double {:.1e} (worst {:.1e}), float {:.1e}; of {} edges {} differ",
                               apart.rmse, apart.worst, in_float.rmse, apart.edges, apart.differing_edges));
    EXPECT_LE(apart.worst, 1e-7);
    EXPECT_LE(apart.rmse, 1e-9);
    EXPECT_LE(apart.differing_edges, 2);  // rays that meet an edge exactly: either side is right
    EXPECT_GT(in_float.rmse, 10 * apart.rmse);
  }
}

// The spread of a picture under a shift of the camera by `aside` of a pixel, right, left, up and down: a
// pixel whose colour moves by more than `step` hangs on an edge: of an object, a shadow, or one seen in a
// mirror.
std::vector<bool> hangs_on_a_hair(const scene::Scene& model, const Picture& picture,
                                  const RenderOptions& options, const std::string& device) {
  constexpr double kAside = 1e-3, kStep = 1e-3;
  std::vector<bool> edge(picture.rgb.size() / 3);
  const scene::Camera& camera = *model.camera;
  const dvec3 way = camera.at - camera.from, right = glm::normalize(glm::cross(way, camera.up));
  const dvec3 up = glm::normalize(glm::cross(right, way));
  const double pixel = 2 * glm::length(way) * std::tan(camera.vertical_fov / 2) / options.height;
  for (const dvec3& shift : {right, -right, up, -up}) {
    scene::Scene moved = model;
    moved.camera->at += shift * pixel * kAside;
    Renderer renderer{Scene(std::move(moved)), {}, {.device = device}};
    const Picture aside = renderer.render(options);
    for (std::size_t i = 0; i < picture.rgb.size(); ++i)
      if (std::abs(aside.rgb[i] - picture.rgb[i]) > kStep) edge[i / 3] = true;
  }
  return edge;
}

struct FloatError {
  double rmse = 0, edge_rmse = 0;
  int edges = 0, visible = 0, visible_edges = 0;  // off by more than 1/255
};

FloatError float_error(const Picture& single, const Picture& reference, const std::vector<bool>& edge) {
  FloatError e;
  double sum = 0, edge_sum = 0;
  for (std::size_t p = 0; p < edge.size(); ++p) {
    double worst = 0;
    for (std::size_t i = 3 * p; i < 3 * p + 3; ++i) {
      const double d = std::abs(double{single.rgb[i]} - reference.rgb[i]);
      worst = std::max(worst, d);
      (edge[p] ? edge_sum : sum) += d * d;
    }
    e.edges += edge[p];
    (edge[p] ? e.visible_edges : e.visible) += worst > 1.0 / 255;
  }
  e.rmse = std::sqrt(sum / (3.0 * static_cast<double>(edge.size())));
  e.edge_rmse = std::sqrt(edge_sum / (3.0 * static_cast<double>(edge.size())));
  return e;
}

scene::Scene generated(const std::string& name, int size) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("kdray_precision_" + name + ".nff");
  {
    std::ofstream out(file);
    generate::generate(name, size, out);
  }
  scene::Scene model = Scene::load(file).model();
  std::filesystem::remove(file);
  return model;
}

TEST_P(Precision64, FloatIsCloseToDouble) {
  for (const auto& [name, size] : {std::pair{"balls", 3}, {"gears", 2}, {"teapot", 6}}) {
    SCOPED_TRACE(name);
    const scene::Scene model = generated(name, size);
    Renderer renderer{Scene(scene::Scene(model)), {}, {.device = GetParam()}};
    const RenderOptions options = exact_options(128, 128), exact = in_double(options);
    const Picture reference = renderer.render(exact);
    const FloatError e = float_error(renderer.render(options), reference,
                                     hangs_on_a_hair(model, reference, exact, GetParam()));
    RecordProperty(name, fmt::format("RMSE {:.1e}, {} of {} pixels visibly off; {} on edges: RMSE {:.1e}, {}",
                                     e.rmse, e.visible, 128 * 128, e.edges, e.edge_rmse, e.visible_edges));
    EXPECT_LE(e.rmse, 1e-5);
    EXPECT_EQ(e.visible, 0);
    EXPECT_LE(e.visible_edges, 0.01 * 128 * 128);
    EXPECT_LE(e.edges, 0.2 * 128 * 128);  // or there would be nothing left to compare
  }
}

TEST_P(Precision64, HitsAreTheOraclesToTheLastPlace) {
  constexpr unsigned kSeed = 161;
  std::mt19937 random(kSeed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(-2, 2);
  for (const NamedScene& named : small_scenes()) {
    SCOPED_TRACE(testing::Message() << named.name << ", seed " << kSeed);
    const scene::Scene model = named.make();
    const Stored stored = as_stored(model);
    const oracle::World world(stored.model);
    const dvec3 size = model.bounds().extent(), middle = model.bounds().center();
    const double reach = 0.1 * std::max({size.x, size.y, size.z});
    std::vector<Ray> rays;
    for (int i = 0; i < 2000; ++i) {
      Ray r{{}, 0, {}, std::numeric_limits<float>::infinity()};
      for (int k = 0; k < 3; ++k) {
        r.origin[k] = static_cast<float>(middle[k] + reach * uniform(random));
        r.direction[k] = normal(random);
      }
      rays.push_back(r);
    }
    Renderer renderer{Scene(scene::Scene(model)), {}, {.device = GetParam()}};
    const std::vector<Hit> hits = renderer.trace(rays, false, 1, Traversal::automatic, Precision::float64);
    const std::vector<Hit> any = renderer.trace(rays, true, 1, Traversal::automatic, Precision::float64);
    int found = 0, uncertain = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray& r = rays[i];
      const oracle::Ray ray{stored.space.local({r.origin[0], r.origin[1], r.origin[2]}),
                            dvec3(r.direction[0], r.direction[1], r.direction[2])};
      const double hair = 1e-13 * (world.extent() + glm::length(ray.origin));
      const oracle::Hit wanted = world.closest(ray);
      // A ray that starts on a surface doesn't hit it there: its interval is open.
      if (wanted.t < hair || world.closest(ray, hair).primitive != wanted.primitive ||
          world.closest(ray, -hair).primitive != wanted.primitive) {
        ++uncertain;
        continue;
      }
      ASSERT_EQ(hits[i].primitive, wanted.primitive) << "ray " << i;
      ASSERT_EQ(any[i].t == 0.0f, wanted.found()) << "ray " << i;
      if (!wanted.found()) continue;
      ++found;
      // Half an ulp of the float, and what a grazing hit loses.
      const oracle::Surface surface = world.surface(ray, wanted);
      const double cosine = std::abs(glm::dot(surface.outward, glm::normalize(ray.direction)));
      ASSERT_LE(std::abs(stored.space.local_length(hits[i].t) - wanted.t),
                0x1p-24 * wanted.t + hair / (cosine * glm::length(ray.direction)))
          << "ray " << i;
    }
    EXPECT_GT(found, 500);
    EXPECT_LE(uncertain, 10);
  }
}

TEST_P(Precision64, WhatItCannotDoIsRefused) {
  Renderer renderer{Scene(glass_and_mirror_balls()), {}, {.device = GetParam()}};
  const RenderOptions double_options = in_double(exact_options(8, 8));
  for (const Traversal t : {Traversal::wide, Traversal::packet, Traversal::batch}) {
    RenderOptions o = double_options;
    o.traversal = t;
    EXPECT_TRUE(fails([&] { (void)renderer.render(o); }, "traversal", ErrorCode::usage));
    EXPECT_TRUE(fails([&] { (void)renderer.trace({}, false, 1, t, Precision::float64); }, "traversal",
                      ErrorCode::usage));
  }
  RenderOptions odprt = double_options, memory = double_options;
  odprt.mode = Mode::odprt;
  memory.device_memory = 1 << 30;
  EXPECT_TRUE(fails([&] { (void)renderer.render(odprt); }, "odprt", ErrorCode::usage));
  EXPECT_TRUE(fails([&] { (void)renderer.render(memory); }, "device memory", ErrorCode::usage));
  (void)renderer.render(double_options);
  EXPECT_EQ(statistics_of(renderer).at("mode").at("precision"), "double");
  EXPECT_EQ(statistics_of(renderer).at("mode").at("traversal"), "binary");
}

// Queues, tiles and samples: the same sums, whoever adds them up; and the extra channels.
TEST_P(Precision64, TheScheduleChangesNothing) {
  const Scene scene{every_light()};
  RenderOptions o = in_double(exact_options(50, 31));
  o.samples = 3;
  o.channels = {"depth", "normal", "primitive"};
  Renderer one(scene, {}, device_of({.device = GetParam()})),
      two(scene, {}, device_of({.device = GetParam(), .queues = 2}));
  const Picture whole = one.render(o);
  o.tile_width = 7, o.tile_height = 3;
  const Picture tiles = two.render(o);
  EXPECT_TRUE(all_finite(whole));
  EXPECT_EQ(whole.rgb, tiles.rgb);
  ASSERT_EQ(whole.channels.size(), tiles.channels.size());
  o.precision = Precision::float32;
  const Picture in_float = one.render(o);
  EXPECT_NE(whole.rgb, in_float.rgb);
  int other_primitives = 0;
  for (std::size_t i = 0; i < 50 * 31; ++i)
    other_primitives += channel(whole, "primitive")[i] != channel(in_float, "primitive")[i];
  EXPECT_LE(other_primitives, 2);
  EXPECT_EQ(channel(whole, "depth"), channel(tiles, "depth"));
}

KDRAY_FOR_EACH_DEVICE(Precision64);

}  // namespace
}  // namespace kdray::test
