// The public interface as a client uses it: pictures, hits, statistics, and errors with their codes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "kdray/kdray.h"
#include "scene/model/scene.h"
#include "support/device.h"

namespace kdray {
namespace {

// A red emitting sphere of radius 1 at the origin, number 1, beside a triangle at z = -2, number 0; grey
// background.
Scene small_scene() {
  scene::Scene s;
  s.vertices = {{-9, -9, -2}, {9, -9, -2}, {0, 9, -2}};
  s.triangles = {{.vertex = {0, 1, 2}, .material = 0, .number = 0}};
  s.spheres = {{.center = {0, 0, 0}, .radius = 1, .material = 1, .number = 1}};
  s.materials = {{.emission = vec3(0, 0.5f, 0)}, {.emission = vec3(1, 0, 0)}};
  s.background = vec3(0.25f);
  s.camera = scene::Camera{.from = {0, 0, 5}, .at = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 0.5};
  return Scene(std::move(s));
}

ErrorCode code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.code();
  }
  ADD_FAILURE() << "no exception";
  return ErrorCode::internal;
}

Ray ray(float x, float y, float z, float dx, float dy, float dz, float t_min = 0,
        float t_max = std::numeric_limits<float>::infinity()) {
  return {{x, y, z}, t_min, {dx, dy, dz}, t_max};
}

class RendererTest : public test::EachDevice {
 protected:
  Renderer renderer(DeviceOptions options = {}) {
    options.device = GetParam();
    return Renderer(small_scene(), {}, options);
  }
};

TEST_P(RendererTest, PicturesHaveTheColoursOfTheScene) {
  Renderer r = renderer();
  double last = 0;
  RenderOptions options{.width = 33, .height = 21, .channels = {"depth", "primitive", "normal", "cost"}};
  options.progress = [&](double share) { last = share; };
  const Picture p = r.render(options);
  ASSERT_EQ(p.rgb.size(), 33u * 21 * 3);
  const std::size_t center = (10 * 33 + 16) * 3;
  EXPECT_EQ(p.rgb[center], 1.0f);
  EXPECT_EQ(p.rgb[center + 1], 0.0f);
  EXPECT_DOUBLE_EQ(last, 1.0);
  ASSERT_EQ(p.channels.size(), 6u);
  EXPECT_EQ(p.channels[0].name, "depth");
  EXPECT_NEAR(p.channels[0].values[center / 3], 4.0f, 1e-3f);
  EXPECT_EQ(p.channels[1].values[center / 3], 1.0f);
  EXPECT_NEAR(p.channels[4].values[center / 3], 1.0f, 1e-3f);  // normal.z, towards the eye
  EXPECT_GT(p.channels[5].values[center / 3], 0.0f);
}

TEST_P(RendererTest, StatisticsHoldTheContract) {
  Renderer r = renderer();
  (void)r.render({.width = 16, .height = 16});
  const auto s = nlohmann::json::parse(to_json(r.statistics()));
  for (const char* key : {"build", "flatten", "upload", "compile", "trace", "shade", "render"})
    EXPECT_TRUE(s.at("seconds").contains(key)) << key;
  EXPECT_EQ(s.at("rays").at("primary"), 256);
  EXPECT_EQ(s.at("rays").at("total"), 256);
  EXPECT_TRUE(s.at("rays").contains("skipped"));
  EXPECT_EQ(s.at("mode").at("name"), "pdprt");
  EXPECT_EQ(s.at("features").at("on"),
            nlohmann::json({"triangles", "spheres", "primitive numbers", "background"}));
  EXPECT_EQ(s.at("tree").at("build"), "balanced");
  // CPUs: the wave, all stages in one. Others: admit, trace_closest, shade; nothing for lights.
  EXPECT_EQ(s.at("mode").at("programs"), s.at("device").at("kind") == "cpu" ? 1 : 3);
}

TEST_P(RendererTest, EveryBuildGivesTheSameHits) {
  const Ray rays[] = {ray(0, 0, 5, 0, 0, -1), ray(3, -3, 5, 0, 0, -1), ray(0, 0, 0, 0, 0, -1),
                      ray(0, 0, 5, 0, 1, 0)};
  const std::vector<Hit> expected = renderer().trace(rays);
  for (const auto& [quality, name] :
       {std::pair{BuildQuality::fast, "fast"}, std::pair{BuildQuality::best, "best"}}) {
    Renderer r(small_scene(), {.quality = quality}, {.device = GetParam()});
    EXPECT_EQ(nlohmann::json::parse(to_json(r.statistics())).at("tree").at("build"), name);
    const std::vector<Hit> hits = r.trace(rays);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(hits[i].t, expected[i].t) << name << " " << i;
      EXPECT_EQ(hits[i].primitive, expected[i].primitive) << name << " " << i;
    }
  }
}

TEST_P(RendererTest, WithoutTheBinaryFormAllOtherWalksGiveTheSamePicture) {
  DeviceOptions device;
  device.device = GetParam();
  Renderer whole(small_scene(), {}, device), without(small_scene(), {.binary_form = false}, device);
  const RenderOptions size{.width = 33, .height = 21};
  const Picture expected = whole.render(size);
  for (const Traversal t : {Traversal::automatic, Traversal::wide, Traversal::packet, Traversal::batch}) {
    RenderOptions options = size;
    options.traversal = t;
    EXPECT_EQ(without.render(options).rgb, expected.rgb) << static_cast<int>(t);
  }
  RenderOptions binary = size;
  binary.traversal = Traversal::binary;
  EXPECT_EQ(whole.render(binary).rgb, expected.rgb);
  EXPECT_EQ(code_of([&] { without.render(binary); }), ErrorCode::usage);
  RenderOptions channels = size;
  channels.channels = {"depth"};
  EXPECT_EQ(code_of([&] { without.render(channels); }), ErrorCode::usage);
  const std::vector<Ray> rays{ray(0, 0, 5, 0, 0, -1)};
  EXPECT_EQ(code_of([&] { without.trace(rays, false, 1, Traversal::binary); }), ErrorCode::usage);
  EXPECT_EQ(without.trace(rays)[0].primitive, whole.trace(rays)[0].primitive);
}

TEST_P(RendererTest, ClosestHitsAreInRayOrderAndInTheirUnits) {
  const Hit miss{std::numeric_limits<float>::infinity(), -1, 0, 0};
  const Ray rays[] = {
      ray(0, 0, 5, 0, 0, -1),       ray(0, 0, 5, 0, 0, -4), ray(0, 0, 5, 0, 0, 1e-30f * -1),
      ray(3, -3, 5, 0, 0, -1),      ray(0, 0, 5, 0, 0, 1),  ray(0, 0, 5, 0, 0, -1, 0, 3.5f),
      ray(0, 0, 5, 0, 0, -1, 4.5f), ray(0, 0, 0, 0, 0, -1), ray(0, 0, 5, 0, 0, -1, 6.5f),
  };
  const std::vector<Hit> hits = renderer().trace(rays);
  EXPECT_FLOAT_EQ(hits[0].t, 4);
  EXPECT_EQ(hits[0].primitive, 1);
  EXPECT_FLOAT_EQ(hits[1].t, 1);
  EXPECT_FLOAT_EQ(hits[2].t, 4e30f);
  EXPECT_FLOAT_EQ(hits[3].t, 7);
  EXPECT_EQ(hits[3].primitive, 0);
  EXPECT_GT(hits[3].u, 0);
  EXPECT_GT(hits[3].v, 0);
  for (const int i : {4, 5}) {
    EXPECT_EQ(hits[static_cast<std::size_t>(i)].t, miss.t) << i;
    EXPECT_EQ(hits[static_cast<std::size_t>(i)].primitive, -1) << i;
  }
  EXPECT_FLOAT_EQ(hits[6].t, 6);  // the sphere's far side
  EXPECT_FLOAT_EQ(hits[7].t, 1);  // from inside
  EXPECT_FLOAT_EQ(hits[8].t, 7);  // beyond the sphere
  EXPECT_EQ(hits[8].primitive, 0);
}

TEST_P(RendererTest, AnyHitSaysOccludedOrNot) {
  const Ray rays[] = {ray(0, 0, 5, 0, 0, -1), ray(0, 0, 5, 0, 0, -1, 0, 3.5f), ray(0, 0, 5, 0, 1, 0)};
  const std::vector<Hit> hits = renderer().trace(rays, true, 3);
  EXPECT_EQ(hits[0].t, 0);
  EXPECT_TRUE(std::isinf(hits[1].t));
  EXPECT_TRUE(std::isinf(hits[2].t));
}

TEST_P(RendererTest, RefusesWhatIsNoRay) {
  Renderer r = renderer();
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const Ray& bad :
       {ray(nan, 0, 0, 0, 0, 1), ray(0, inf, 0, 0, 0, 1), ray(0, 0, 0, 0, 0, 0), ray(0, 0, 0, nan, 0, 1),
        ray(0, 0, 0, 0, inf, 1), ray(0, 0, 0, 0, 0, 1, nan), ray(0, 0, 0, 0, 0, 1, 0, nan)})
    EXPECT_EQ(code_of([&] { (void)r.trace(std::span(&bad, 1)); }), ErrorCode::input);
  EXPECT_TRUE(r.trace({}).empty());
}

TEST_P(RendererTest, AnEmptySceneShowsItsBackground) {
  scene::Scene empty;
  empty.background = vec3(0.25f, 0.5f, 1);
  Renderer r(Scene(std::move(empty)), {}, {.device = GetParam()});
  const Picture p = r.render({.width = 4, .height = 4});
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(p.rgb[i * 3], 0.25f);
    EXPECT_EQ(p.rgb[i * 3 + 2], 1.0f);
  }
  const Ray one = ray(0, 0, 0, 0, 0, 1);
  EXPECT_EQ(r.trace(std::span(&one, 1))[0].primitive, -1);
}

TEST_P(RendererTest, OptionsOutOfRangeAreUsageErrors) {
  Renderer r = renderer();
  EXPECT_EQ(code_of([&] { (void)r.render({.width = 65536, .height = 65536}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { (void)r.render({.width = 8, .height = 8, .channels = {"warmth"}}); }),
            ErrorCode::usage);
  EXPECT_EQ(code_of([&] {
              (void)r.render(
                  {.width = 8192, .height = 8192, .samples = 256, .tile_width = 8192, .tile_height = 8192});
            }),
            ErrorCode::usage);
  EXPECT_EQ(code_of([&] { (void)renderer({.queues = 0}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { (void)renderer({.work_group = 1 << 30}); }), ErrorCode::usage);
}

KDRAY_FOR_EACH_DEVICE(RendererTest);

TEST(Devices, AnUnknownDeviceIsNoDevice) {
  EXPECT_EQ(code_of([] { Renderer(small_scene(), {}, {.device = "abacus"}); }), ErrorCode::no_device);
}

TEST(SceneLoad, AMissingFileIsAnInputError) {
  EXPECT_EQ(code_of([] { (void)Scene::load("/no/such/scene.nff"); }), ErrorCode::input);
}

}  // namespace
}  // namespace kdray
