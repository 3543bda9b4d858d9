// What    Soft shadows on a floor against the integral over what each point sees of the light, with a half
//         plane in between whose edge cuts the light in a straight line; how fast the error falls with
//         samples; and the same bits however the frame is divided.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "pictures/scenes.h"

namespace kdray::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLight = 4, kEdge = 2;  // heights above the floor
constexpr int kPixels = 48;

// A floor at y = 0, and a sheet at kEdge that covers all where x < 0. The camera is between the two.
scene::Scene shaded_by_a_sheet(const scene::Light& light) {
  oracle::SceneBuilder b;
  b.quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, oracle::matte(vec3(1)));
  b.quad({-50, kEdge, 50}, {50, 0, 0}, {0, 0, -100}, oracle::matte(vec3(1)));
  scene::Scene s = b.light(light).scene();
  s.camera = scene::Camera{.from = {0, 1, 0}, .at = {0, 0, 0}, .up = {0, 0, 1}, .ortho_width = 4};
  return s;
}

scene::Light light_of(scene::LightKind kind) {
  scene::Light light;
  light.kind = kind;
  light.position = {0.1, kLight, 0};
  if (kind == scene::LightKind::sphere) light.radius = 0.9;
  if (kind == scene::LightKind::rectangle) light.across = {1.6, 0, 0}, light.down = {0, 0, 1.2};
  if (kind == scene::LightKind::disc) light.across = {0.9, 0, 0}, light.down = {0, 0, 0.9};
  return light;
}

double integral(double from, double to, int n, const std::function<double(double)>& f) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += f(from + (to - from) * (i + 0.5) / n);
  return to > from ? sum * (to - from) / n : 0;
}

// The floor at (x, 0, 0) sees what of the light lies beyond this x.
double seen_from(double x) {
  return x - x * kLight / kEdge;
}

double cosine(double x, double light_x, double light_z) {
  return kLight / std::sqrt((light_x - x) * (light_x - x) + kLight * kLight + light_z * light_z);
}

double of_rectangle(double x) {
  const double lo = std::max(0.1 - 0.8, seen_from(x)), hi = 0.1 + 0.8;
  return integral(
             lo, hi, 200,
             [&](double u) { return integral(-0.6, 0.6, 100, [&](double v) { return cosine(x, u, v); }); }) /
         (1.6 * 1.2);
}

double of_disc(double x) {
  const double lo = std::max(0.1 - 0.9, seen_from(x)), hi = 0.1 + 0.9;
  return integral(lo, hi, 2000,
                  [&](double u) {
                    const double chord = std::sqrt(std::max(0.0, 0.81 - (u - 0.1) * (u - 0.1)));
                    return integral(-chord, chord, 100, [&](double v) { return cosine(x, u, v); });
                  }) /
         (kPi * 0.81);
}

// The mean over the cone of directions in which the sphere is seen, of the part on the light's side of the
// plane through the point and the sheet's edge: on each circle around the cone's axis an arc.
double of_sphere(double x) {
  const dvec3 way(0.1 - x, kLight, 0), w = glm::normalize(way);
  const dvec3 plane = glm::normalize(dvec3(kEdge, x, 0));  // its normal, towards what isn't covered
  const double half_angle = std::asin(0.9 / glm::length(way)), above = glm::dot(plane, w);
  const dvec3 m = glm::normalize(plane - above * w);
  const double least = above / std::sqrt(1 - above * above);
  const double sum = integral(0, half_angle, 4000, [&](double theta) {
    const double arc = std::acos(std::clamp(-least / std::tan(theta), -1.0, 1.0));
    return std::sin(theta) * (2 * arc * std::cos(theta) * w.y + 2 * std::sin(arc) * std::sin(theta) * m.y);
  });
  return sum / (2 * kPi * (1 - std::cos(half_angle)));
}

struct Case {
  const char* name;
  scene::LightKind kind;
  double (*truth)(double x);
};

class SoftShadow : public testing::TestWithParam<Case> {};

// The root of the mean square of what the pixels are off by.
double error_of(const Picture& picture, const Case& c) {
  double sum = 0;
  for (int i = 0; i < kPixels; ++i) {
    const double width = 4.0 / kPixels, x = 2 - width * (i + 0.5);  // the camera's right is -x
    const double wanted = integral(x - width / 2, x + width / 2, 8, c.truth) / width;
    for (int row = 0; row < picture.height; ++row) {
      const double off = picture.rgb[static_cast<std::size_t>(3 * (row * kPixels + i))] - wanted;
      sum += off * off;
    }
  }
  return std::sqrt(sum / (kPixels * picture.height));
}

double error_with(const Case& c, int samples) {
  Renderer renderer(Scene{shaded_by_a_sheet(light_of(c.kind))}, {}, device_of());
  RenderOptions options = exact_options(kPixels, 8, 1);
  options.samples = samples;
  return error_of(renderer.render(options), c);
}

TEST_P(SoftShadow, IsTheIntegralOverWhatIsSeenOfTheLight) {
  EXPECT_LT(error_with(GetParam(), 4096), 0.0015);
}

// Samples by chance would have a quarter of the error with sixteen times as many; samples in strata, n^-0.75,
// have an eighth.
TEST_P(SoftShadow, IsSampledInStrata) {
  const double of_16 = error_with(GetParam(), 16), of_256 = error_with(GetParam(), 256);
  RecordProperty("error_of_16", std::to_string(of_16));
  RecordProperty("error_of_256", std::to_string(of_256));
  EXPECT_LT(of_16, 0.08);
  EXPECT_LT(of_256, of_16 / 6);
}

// What adaptive sampling believes of the noise is about what it is.
TEST_P(SoftShadow, IsRefinedUntilItsNoiseIsWithinTheTarget) {
  constexpr double kTarget = 0.03;
  Renderer renderer(Scene{shaded_by_a_sheet(light_of(GetParam().kind))}, {}, device_of());
  RenderOptions options = exact_options(kPixels, 32, 1);
  options.samples = 0;
  options.adaptive_target = kTarget;
  const double error = error_of(renderer.render(options), GetParam());
  const auto believed = statistics_of(renderer)["samples"]["estimated_rmse"].get<double>();
  EXPECT_LE(believed, kTarget);
  EXPECT_LT(error, 1.5 * believed);
  EXPECT_GT(error, 0.5 * believed);
}

INSTANTIATE_TEST_SUITE_P(Lights, SoftShadow,
                         testing::Values(Case{"rectangle", scene::LightKind::rectangle, of_rectangle},
                                         Case{"disc", scene::LightKind::disc, of_disc},
                                         Case{"sphere", scene::LightKind::sphere, of_sphere}),
                         [](const auto& info) { return info.param.name; });

// A point within a sphere is lit, and nothing comes between.
TEST(AreaLights, APointWithinASphereIsLit) {
  scene::Light light = light_of(scene::LightKind::sphere);
  light.position = {0, 0.5, 0};
  light.radius = 30;
  Renderer renderer(Scene{shaded_by_a_sheet(light)}, {}, device_of());
  RenderOptions options = exact_options(4, 4, 1);
  options.samples = 64;
  const Picture picture = renderer.render(options);
  EXPECT_TRUE(all_finite(picture));
  EXPECT_GT(*std::min_element(picture.rgb.begin(), picture.rgb.end()), 0.05f);
}

// The same samples, wherever rays go: by pixel, number, light and depth alone.
TEST(AreaLights, TheSameBitsInEachModeWithManySamples) {
  for (const auto& make : {soft_light, under_a_sky}) {
    const Scene scene{make()};
    for (const bool adaptive : {false, true}) {
      RenderOptions options = exact_options(61, 43);
      options.samples = adaptive ? 0 : 5;
      options.adaptive_target = adaptive ? 0.02 : 0;
      const Picture first = Renderer(scene, {}, device_of()).render(options);
      for (const int queues : {1, 3}) {
        Renderer renderer(scene, {}, device_of({.queues = queues}));
        for (const Mode mode : {Mode::pdprt, Mode::odprt}) {
          options.mode = mode;
          EXPECT_TRUE(same_bits(first.rgb, renderer.render(options).rgb))
              << queues << " queues, mode " << static_cast<int>(mode) << ", adaptive " << adaptive;
        }
        options.mode = Mode::automatic;
      }
    }
  }
}

// A light of no size is a point's, but for rounding.
TEST(AreaLights, TinyOnesAreLikePoints) {
  scene::Scene points = soft_light(), tiny = points;
  for (scene::Light& l : tiny.lights) l.across *= 1e-7, l.down *= 1e-7, l.radius *= 1e-7;
  for (scene::Light& l : points.lights)
    if (scene::has_area(l.kind)) l.kind = scene::LightKind::point, l.across = l.down = dvec3(0), l.radius = 0;
  const Picture a = Renderer(Scene{std::move(points)}, {}, device_of()).render(exact_options(90, 70));
  const Picture b = Renderer(Scene{std::move(tiny)}, {}, device_of()).render(exact_options(90, 70));
  std::size_t apart = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) apart += std::abs(a.rgb[i] - b.rgb[i]) > 1e-4f ? 1 : 0;
  EXPECT_LT(apart, a.rgb.size() / 500);
}

}  // namespace
}  // namespace kdray::test
