// What    Real models from the file to the picture: what is seen lies where the model is, is what brute force
//         in double says is there, and is neither black nor burnt out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "oracle/oracle.h"
#include "pictures/render.h"
#include "support/data.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 128, kHeight = 96;

struct RealScene {
  const char* file;
  double least_hits, most_hits;  // share of pixels that see something
  double darkest, brightest;     // mean luminance
};

void PrintTo(const RealScene& s, std::ostream* out) {
  *out << s.file;
}

std::string test_name(std::string file) {
  file = file.substr(file.rfind('/') + 1);
  file = file.substr(0, file.find('.'));
  std::replace_if(
      file.begin(), file.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return file;
}

oracle::Ray pixel_ray(const scene::Scene& model, int pixel) {
  return oracle::eye_ray(*model.camera, pixel % kWidth + 0.5, pixel / kWidth + 0.5, kWidth, kHeight);
}

// Depth, normal and primitive agree with each other and with the model's bounds.
void expect_consistent_channels(const Picture& picture, const Scene& scene) {
  const std::vector<float>&depth = channel(picture, "depth"), &primitive = channel(picture, "primitive");
  const std::vector<float>&x = channel(picture, "normal.x"), &y = channel(picture, "normal.y"),
        &z = channel(picture, "normal.z");
  const DBox box = scene.model().bounds();
  const double slack =
      1e-4 * glm::length(box.extent()) + 1e-5 * glm::length(scene.model().camera->from - box.lo);
  int wrong = 0;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const double length = std::sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    if (primitive[i] < 0) {
      wrong += !(std::isinf(depth[i]) && length == 0);
      continue;
    }
    const oracle::Ray ray = pixel_ray(scene.model(), i);
    const dvec3 p = ray.origin + static_cast<double>(depth[i]) * ray.direction;
    const bool inside =
        glm::all(glm::greaterThanEqual(p, box.lo - slack)) && glm::all(glm::lessThanEqual(p, box.hi + slack));
    wrong +=
        !(inside && std::abs(length - 1) < 1e-3 && primitive[i] < static_cast<float>(scene.primitives()));
  }
  EXPECT_EQ(wrong, 0) << "pixels whose channels contradict each other or the model's bounds";
}

// Random pixels against brute force. A pixel counts only if no rounding could change what it sees.
void expect_brute_force_agrees(const Picture& picture, const Scene& scene, int samples) {
  const unsigned seed = 1987;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any_pixel(0, kWidth * kHeight - 1);
  const oracle::World world(scene.model());
  const std::vector<float>&depth = channel(picture, "depth"), &primitive = channel(picture, "primitive");
  int judged = 0;
  for (int i = 0; i < samples; ++i) {
    const int pixel = any_pixel(random);
    const oracle::Ray ray = pixel_ray(scene.model(), pixel);
    const double rounding =
        2e-6 * (world.extent() + glm::length(ray.origin - scene.model().bounds().center()));
    const oracle::Hit hit = world.closest(ray);
    if (world.closest(ray, rounding).primitive != hit.primitive) continue;
    if (world.closest(ray, -rounding).primitive != hit.primitive) continue;
    ++judged;
    if (!hit.found()) {
      EXPECT_LT(primitive[pixel], 0) << "pixel " << pixel;
      continue;
    }
    const double cosine = std::abs(glm::dot(world.surface(ray, hit).outward, ray.direction));
    EXPECT_NEAR(depth[pixel], hit.t, 1e-5 * hit.t + rounding / cosine) << "pixel " << pixel;
    // Coinciding surfaces: any of them is right.
    const bool tie = std::abs(depth[pixel] - hit.t) <= 1e-6 * hit.t;
    EXPECT_TRUE(tie || static_cast<int>(primitive[pixel]) == hit.primitive) << "pixel " << pixel;
  }
  EXPECT_GT(judged, samples / 4);
}

class RealScenes : public testing::TestWithParam<RealScene> {};

TEST_P(RealScenes, ShowTheModel) {
  const RealScene& wanted = GetParam();
  const std::filesystem::path file = data_path(wanted.file);
  KDRAY_NEED_DATA(file);
  const Scene scene = Scene::load(file);
  ASSERT_TRUE(scene.model().camera.has_value());
  EXPECT_FALSE(scene.model().lights.empty());
  Renderer renderer(scene, {}, device_of());
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.samples = 1;
  options.channels = {"depth", "normal", "primitive"};
  const Picture picture = renderer.render(options);
  ASSERT_EQ(picture.rgb.size(), 3u * kWidth * kHeight);
  EXPECT_TRUE(all_finite(picture));
  EXPECT_GE(*std::ranges::min_element(picture.rgb), 0.0f);

  const std::vector<float>& primitive = channel(picture, "primitive");
  ASSERT_EQ(primitive.size(), static_cast<std::size_t>(kWidth * kHeight));
  const auto hits = std::ranges::count_if(primitive, [](float p) { return p >= 0; });
  const double share = static_cast<double>(hits) / (kWidth * kHeight);
  EXPECT_GE(share, wanted.least_hits);
  EXPECT_LE(share, wanted.most_hits);
  EXPECT_GE(mean_luminance(picture), wanted.darkest);
  EXPECT_LE(mean_luminance(picture), wanted.brightest);
  expect_consistent_channels(picture, scene);
  expect_brute_force_agrees(picture, scene, scene.primitives() > 100000 ? 30 : 200);
}

// Shares of hits and luminance: a model framed as a whole fills between a tenth and nine tenths of the
// picture.
INSTANTIATE_TEST_SUITE_P(
    Files, RealScenes,
    testing::Values(RealScene{"stanford/dragon_vrip.ply.xz", 0.1, 0.9, 0.02, 0.9},
                    RealScene{"stanford/bunny_zipper_ascii.ply.xz", 0.1, 0.9, 0.02, 0.9},
                    RealScene{"interior/classroom/classroom.obj.xz", 0.1, 1, 0.02, 1.5},
                    RealScene{"gltf/DamagedHelmet.glb", 0.1, 0.9, 0.005, 0.9},  // of metal, in the dark
                    RealScene{"interior/cornell/CornellBox-Empty-CO.obj", 0.1, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Empty-RG.obj", 0.1, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Empty-Squashed.obj.xz", 0.05, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Empty-White.obj", 0.1, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Glossy.obj.xz", 0.1, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Mirror.obj", 0.1, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Original.obj", 0.1, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Sphere.obj.xz", 0.1, 0.95, 0.02, 1.5},
                    RealScene{"interior/cornell/CornellBox-Water.obj.xz", 0.1, 0.95, 0.02, 1.5}),
    [](const auto& info) { return test_name(info.param.file); });

}  // namespace
}  // namespace kdray::test
