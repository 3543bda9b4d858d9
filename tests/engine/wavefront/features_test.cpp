// A small picture for every feature mask that matters, by a launch per stage: every bit alone, every pair
// whose code meets, all. The scene is made to have exactly the mask's features, so a mask that is left out of
// the table below is not tested. Everything is called from one thread and the pictures are tiny, so that
// scripts/portability can run these under Oclgrind's checks for memory errors, data races and uninitialised
// reads (docs/design/portability.md).
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "accel/flatten/features.h"
#include "accel/flatten/flatten.h"
#include "accel/flatten/frame.h"
#include "accel/flatten/wide.h"
#include "accel/kdtree/build.h"
#include "conformance/samples.h"
#include "engine/wavefront/channels.h"
#include "engine/wavefront/develop.h"
#include "engine/wavefront/tile_order.h"
#include "engine/wavefront/wavefront.h"
#include "layout/features.h"
#include "scene/model/geometry.h"
#include "support/device.h"

namespace kdray::wavefront {
namespace {

constexpr layout::Features kT = KDRAY_FEATURE_KIND(TRIANGLE), kSmooth = KDRAY_FEATURE_SMOOTH,
                           kNumbers = KDRAY_FEATURE_NUMBERS, kReflect = KDRAY_FEATURE_REFLECT,
                           kTransmit = KDRAY_FEATURE_TRANSMIT, kSpecular = KDRAY_FEATURE_SPECULAR,
                           kDiffuse = KDRAY_FEATURE_DIFFUSE, kLights = KDRAY_FEATURE_LIGHTS,
                           kFallOff = KDRAY_FEATURE_ATTENUATION, kDirectional = KDRAY_FEATURE_DIRECTIONAL,
                           kSpot = KDRAY_FEATURE_SPOT, kBackground = KDRAY_FEATURE_BACKGROUND,
                           kSamples = KDRAY_FEATURE_SUPERSAMPLE, kZeroArea = KDRAY_FEATURE_ZERO_AREA,
                           kMaps = KDRAY_FEATURE_MATERIAL_MAPS, kColors = KDRAY_FEATURE_CORNER_COLORS,
                           kTextures = KDRAY_FEATURE_TEXTURES, kCutouts = KDRAY_FEATURE_CUTOUTS,
                           kSky = KDRAY_FEATURE_SKY, kArea = KDRAY_FEATURE_AREA_LIGHTS,
                           kLens = KDRAY_FEATURE_LENS, kFloor = KDRAY_FEATURE_FLOOR;
constexpr layout::Features kKinds = (KDRAY_FEATURE_OF_KIND(primitives::kKinds) - 1) & KDRAY_FEATURE_ALL_KINDS;
constexpr layout::Features kLit = kDiffuse | kLights,
                           kAll = kKinds | kZeroArea | kSmooth | kNumbers | kReflect | kTransmit | kSpecular |
                                  kLit | kFallOff | kDirectional | kSpot | kBackground | kSamples | kMaps |
                                  kColors | kTextures | kCutouts | kSky | kArea | kLens | kFloor;

constexpr std::uint64_t kSeed = 3;

bool has(layout::Features mask, layout::Features bit) {
  return (mask & bit) != 0;
}

scene::Material material_of(layout::Features mask) {
  scene::Material m{.ambient = vec3(0.2f, 0.1f, 0.15f), .shine = 12, .index = 1.4f};
  if (has(mask, kDiffuse)) m.diffuse = vec3(0.5f, 0.4f, 0.3f);
  if (has(mask, kSpecular)) m.specular = vec3(0.4f);
  if (has(mask, kReflect)) m.reflect = vec3(0.3f, 0.5f, 0.4f);
  if (has(mask, kTransmit)) m.transmit = vec3(0.6f, 0.5f, 0.7f);
  return m;
}

// Above the objects, so that some shadows fall on them. Where the mask has none, but nothing shines either,
// there is one that changes nothing.
std::vector<scene::Light> lights_of(layout::Features mask) {
  if (!has(mask, kLights) && !has(mask, kDiffuse | kSpecular)) return {{.position = {1, 4, 3}}};
  if (!has(mask, kLights)) return {};
  std::vector<scene::Light> lights{{.position = {1, 4, 3}, .color = vec3(0.5f)},
                                   {.position = {-4, 3, 1}, .color = vec3(0.3f)}};
  if (has(mask, kFallOff)) lights[0].attenuation = {0.5f, 0.1f, 0.02f}, lights[1].range = 5;
  if (has(mask, kDirectional))
    lights.push_back(
        {.kind = scene::LightKind::directional, .direction = {0, -0.6, -0.8}, .color = vec3(0.4f)});
  if (has(mask, kSpot))
    lights.push_back({.kind = scene::LightKind::spot,
                      .position = {0, 5, 0},
                      .direction = {0, -1, 0},
                      .color = vec3(0.6f),
                      .cos_inner = 0.95f,
                      .cos_outer = 0.8f});
  if (has(mask, kArea))
    lights.push_back({.kind = scene::LightKind::rectangle,
                      .position = {2, 4, 2},
                      .color = vec3(0.4f),
                      .across = {1, 0, 0},
                      .down = {0, 0.3, 1}});
  return lights;
}

void add_triangles(scene::Scene& s, layout::Features mask, std::uint32_t first_number) {
  s.vertices = {{-3, -1, -2}, {3, -1, -2}, {0, -1, 3}, {-1.5, -0.9, -1}, {1, -0.8, -1.2}, {0.2, 1.4, -1.4}};
  if (has(mask, kSmooth)) s.normals = {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}};
  for (std::uint32_t i = 0; i < 2; ++i) {
    scene::Triangle t{.vertex = {3 * i, 3 * i + 1, 3 * i + 2}, .number = first_number + i};
    if (i == 1 && has(mask, kSmooth)) t.normal = {0, 1, 2};
    s.triangles.push_back(t);
  }
  if (!has(mask, kZeroArea)) return;
  // An edge of the first, and its middle.
  s.vertices.push_back({0, -1, -2});
  s.triangles.push_back({.vertex = {0, 6, 1}, .number = first_number + 2});
}

// A picture of three by two, more than half there, on all triangles.
void add_maps(scene::Scene& s, layout::Features mask) {
  scene::MaterialMaps maps{.diffuse = std::exchange(s.materials[0].diffuse, vec3(0))};
  if (has(mask, kTextures)) {
    auto picture = std::make_shared<scene::Picture>(scene::blank_picture("p", 3, 2));
    std::uint8_t* to = picture->texels.data();
    for (int i = 0; i < 6; ++i)
      for (const int byte : {40 * i, 200, 90, i == 2 ? 0 : 255}) *to++ = static_cast<std::uint8_t>(byte);
    s.texturing.pictures = {picture};
    maps.base = s.texturing.add(scene::Texture{});
    s.texturing.texcoords[0].assign(s.triangles.size(), {{{0, 0}, {2, 0}, {1, 1.5f}}});
  }
  if (has(mask, kColors)) {
    maps.colored = 1;
    s.texturing.colors.assign(s.triangles.size(),
                              {{{0xffff8000u, 0xffff4000u}, {0x1234ffffu, 0xffffffffu}, {0, ~0u}}});
  }
  if (has(mask, kCutouts)) maps.mode = scene::Alpha::mask;
  s.materials[0].maps = s.texturing.add(maps);
}

scene::Scene scene_of(layout::Features mask) {
  scene::Scene s;
  s.materials = {material_of(mask)};
  s.lights = lights_of(mask);
  const std::uint32_t first_number = has(mask, kNumbers) ? 3 : 0;
  if (has(mask, kT)) add_triangles(s, mask, first_number);
  if (has(mask, kMaps)) add_maps(s, mask);
  test::Draw draw(kSeed);
  primitives::for_each_shape([&](auto kind) {
    if (!has(mask, KDRAY_FEATURE_OF_KIND(kind.kNumber))) return;
    for (std::uint32_t i = 0; i < 30; ++i) {
      test::Samples<decltype(kind)>::add(s, 0, draw);
      decltype(kind)::of(s).back().number = first_number + i;
    }
  });
  if (has(mask, kBackground)) s.background = {0.1f, 0.2f, 0.3f};
  if (has(mask, kSky)) {
    s.sky = {.kind = scene::SkyKind::gradient, .stops = {{-1, {0.1f, 0.2f, 0.3f}}, {1, {0.2f, 0.3f, 0.4f}}}};
    s.sky.brightest = scene::brightest_of(s.sky);
  }
  if (has(mask, kFloor))
    s.framing.floor = {.middle = {0, -1.2, 0},
                       .inner = 2,
                       .radius = 8,
                       .unshadowed = vec3(0.1f),
                       .diffuse = vec3(0.5f),
                       .reflect = has(mask, kReflect) ? 0.2f : 0.0f};
  s.camera = scene::Camera{.from = {0.5, 0.8, 5}, .at = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 0.7};
  if (has(mask, kLens)) s.camera->aperture = 0.1;
  return s;
}

struct RenderedFrame {
  std::vector<layout::i64> film;
  Counters counters;
};

// A scene of exactly these features on a device, and its programs, which pictures share.
class Subject {
 public:
  Subject(const device::Context& context, layout::Features mask) : context_(context), scene_(scene_of(mask)) {
    options_.width = 9;
    options_.height = 7;
    options_.depth = 3;
    options_.samples = has(mask, kSamples) ? 3 : 1;
    options_ = flatten::resolved(options_, {});
    features_ = flatten::features_of(scene_, geometry_) | flatten::features_of_samples(options_.samples);
  }

  layout::Features features() const { return features_; }

  RenderedFrame draw(const Schedule& schedule) {
    layout::Frame frame = flatten::make_frame(scene_, geometry_, options_);
    schedule.apply(frame, features_);
    const std::vector<layout::u32> tiles = tile_curve(frame.n_tiles_x, 0, frame.n_tiles / frame.n_tiles_x);
    const std::size_t n_pixels = std::size_t{frame.width} * frame.height;
    Wavefront wavefront(context_, context_.queues().front(), buffers_, schedule.fused ? waves_ : stages_,
                        frame, schedule, features_, {.tiles = tiles.size(), .pixels = n_pixels});
    wavefront.begin(0);
    std::span<const layout::u32> left = tiles;
    wavefront.render([&](const Progress&) { return std::exchange(left, {}); });
    RenderedFrame rendered;
    const FilmPiece all[] = {{0, n_pixels}};
    wavefront.finish(all, [&](std::size_t, const FilmSums& film) {
      rendered.film.assign(film.sums.begin(), film.sums.end());
    });
    rendered.counters = wavefront.counters();
    return rendered;
  }

  // The programs have all that they may have, the host goes by the scene as before.
  void have_everything() { stages_.have_everything(), waves_.have_everything(); }

  std::vector<image::Channel> channels() {
    layout::Frame frame = flatten::make_frame(scene_, geometry_, options_);
    Schedule{}.apply(frame, features_);
    const std::vector<std::string> names = {"depth", "normal", "primitive", "cost"};
    const ChannelQueue queue{context_, buffers_, waves_, context_.queues().front()};
    return render_channels({&queue, 1}, frame, geometry_.space, features_, Precision::float32, names);
  }

 private:
  const device::Context& context_;
  scene::Scene scene_;
  scene::Geometry geometry_ = scene::make_geometry(scene_);
  kdtree::Tree tree_ = kdtree::build(geometry_);
  flatten::FlatScene flat_ = flatten::flatten(scene_, geometry_, tree_);
  flatten::WideForm wide_ = flatten::make_wide(tree_, flat_, flatten::choose_block(tree_));
  SceneBuffers buffers_{context_, flat_, wide_};
  // Stages' programs are compiled as they stand, since hundreds are: that takes two thirds of the time.
  Programs stages_{context_, tree_.max_depth, wide_, " -cl-opt-disable"};
  Programs waves_{context_, tree_.max_depth, wide_};
  RenderOptions options_;
  layout::Features features_;
};

// As on GPUs: a launch per stage, a ray per work-item; batches that aren't full, several slices and groups.
// Streams are filled, so that a checker of uninitialised reads says nothing of the lanes behind the last ray,
// which hold anything by design: FreshMemoryDoesNotShow is about those.
const Schedule kByStages{.tile_width = 4,
                         .tile_height = 4,
                         .batch_size = 24,
                         .n_slices = 3,
                         .fused = false,
                         .work_group = 32,
                         .fill = 0};

std::vector<layout::Features> kinds() {
  std::vector<layout::Features> all;
  primitives::for_each_kind([&](auto kind) { all.push_back(KDRAY_FEATURE_OF_KIND(kind.kNumber)); });
  return all;
}

// Each kind alone and with each other.
std::vector<layout::Features> geometry_masks() {
  std::vector<layout::Features> masks{0, kT, kT | kSmooth | kLit, kT | kZeroArea | kLit,
                                      kKinds | kNumbers | kLit};
  for (const layout::Features a : kinds()) {
    masks.push_back(a | kNumbers | kLit);
    for (const layout::Features b : kinds())
      if (a <= b) masks.push_back(a | b | kLit);
  }
  return masks;
}

std::vector<layout::Features> materials_masks() {
  std::vector<layout::Features> masks{kT | kDiffuse,
                                      kT | kSpecular,
                                      kT | kReflect,
                                      kT | kTransmit,
                                      kT | kSpecular | kLights,
                                      kT | kSpecular | kLit,
                                      kT | kReflect | kLit,
                                      kT | kTransmit | kLit,
                                      kT | kReflect | kTransmit | kLit,
                                      kT | kSmooth | kSpecular | kLit,
                                      kT | kSmooth | kReflect | kLit,
                                      kT | kSmooth | kTransmit | kLit};
  for (const layout::Features kind : kinds())
    if (kind != kT) masks.insert(masks.end(), {kind | kReflect | kLit, kind | kTransmit | kLit});
  return masks;
}

const std::vector<layout::Features> kTexturingMasks = {
    kT | kLit | kMaps,
    kT | kLit | kMaps | kColors,
    kT | kLit | kMaps | kTextures,
    kT | kLit | kMaps | kTextures | kColors,
    kT | kLit | kMaps | kTextures | kCutouts,
    kT | kLit | kMaps | kColors | kCutouts,
    kT | kSmooth | kLit | kMaps | kTextures,
    kT | kTransmit | kLit | kMaps | kTextures | kCutouts,
    kKinds | kNumbers | kLit | kMaps | kTextures | kCutouts};
const std::vector<layout::Features> kLightsMasks = {kT | kLit | kFallOff,
                                                    kT | kLit | kDirectional,
                                                    kT | kLit | kSpot,
                                                    kT | kLit | kFallOff | kDirectional,
                                                    kT | kLit | kFallOff | kSpot,
                                                    kT | kLit | kDirectional | kSpot,
                                                    kT | kLit | kSpecular | kSpot,
                                                    kT | kLit | kArea,
                                                    kT | kLit | kArea | kFallOff | kSamples,
                                                    kT | kReflect | kTransmit | kLit | kArea};
const std::vector<layout::Features> kFilmMasks = {kBackground,
                                                  kT | kBackground,
                                                  kT | kLit | kSamples,
                                                  kT | kLit | kSamples | kBackground,
                                                  kT | kReflect | kBackground,
                                                  kT | kTransmit | kBackground,
                                                  kT | kReflect | kLit | kSamples,
                                                  kBackground | kSky,
                                                  kT | kReflect | kBackground | kSky,
                                                  kT | kLit | kFloor,
                                                  kT | kReflect | kLit | kFloor | kBackground | kSky,
                                                  kT | kLit | kFloor | kArea | kSamples,
                                                  kT | kLit | kLens,
                                                  kT | kLit | kLens | kSamples};

class FeaturesTest : public test::EachDevice {
 protected:
  const device::Context context_{GetParam(), 1};

  void draw(const std::vector<layout::Features>& masks) {
    for (const layout::Features mask : masks) {
      Subject subject(context_, mask);
      SCOPED_TRACE(fmt::format("{:#010x}: {}", mask, fmt::join(flatten::feature_names(mask).on, ", ")));
      ASSERT_EQ(subject.features(), mask);
      const RenderedFrame rendered = subject.draw(kByStages);
      const Counters& n = rendered.counters;
      EXPECT_EQ(n.primary, 63u * (has(mask, kSamples) ? 3 : 1));
      EXPECT_EQ(n.primary_hit > 0, has(mask, kKinds));
      EXPECT_EQ(n.shadow > 0, has(mask, kLights));
      // Glass reflects too, where refraction is impossible.
      EXPECT_EQ(n.reflected > 0, has(mask, kReflect | (n.reflected > 0 ? kTransmit : 0)));
      EXPECT_EQ(n.refracted > 0, has(mask, kTransmit));
      const bool all_dark = std::ranges::all_of(rendered.film, [](layout::i64 sum) { return sum == 0; });
      EXPECT_EQ(all_dark, !has(mask, kKinds | kBackground));
    }
  }

  // By programs that take the place of the scene's own (device/opencl/variant.h): no bit, and no ray, is
  // another.
  void expect_the_same_with_everything(const std::vector<layout::Features>& masks, const Schedule& schedule) {
    for (const layout::Features mask : masks) {
      Subject subject(context_, mask);
      SCOPED_TRACE(fmt::format("{:#010x}: {}", mask, fmt::join(flatten::feature_names(mask).on, ", ")));
      const RenderedFrame own = subject.draw(kByStages);
      subject.have_everything();
      const RenderedFrame everything = subject.draw(schedule);
      EXPECT_EQ(everything.film, own.film);
#define KDRAY_EXPECT_THE_SAME(name, field, key) \
  EXPECT_EQ(everything.counters.name, own.counters.name) << (key);
      KDRAY_COUNTERS_OF_TRACED(KDRAY_EXPECT_THE_SAME)
      KDRAY_COUNTERS_OF_SKIPPED(KDRAY_EXPECT_THE_SAME)
#undef KDRAY_EXPECT_THE_SAME
    }
  }

  void expect_the_same_in_one_launch(Traversal walk) {
    Subject subject(context_, kAll);
    Schedule schedule = kByStages;
    schedule.fused = true;
    schedule.traversal = walk;
    EXPECT_EQ(subject.draw(schedule).film, subject.draw(kByStages).film);
  }
};

TEST_P(FeaturesTest, Geometry) {
  draw(geometry_masks());
}

TEST_P(FeaturesTest, Materials) {
  draw(materials_masks());
}

TEST_P(FeaturesTest, Texturing) {
  draw(kTexturingMasks);
}

TEST_P(FeaturesTest, Lights) {
  draw(kLightsMasks);
}

TEST_P(FeaturesTest, Film) {
  draw(kFilmMasks);
}

TEST_P(FeaturesTest, All) {
  draw({kAll});
}

// The larger of the groups that GPUs have; all else here is in groups of 32.
TEST_P(FeaturesTest, GroupsOf64) {
  Subject subject(context_, kAll);
  Schedule schedule = kByStages;
  schedule.work_group = 64;
  const RenderedFrame by_32 = subject.draw(kByStages), by_64 = subject.draw(schedule);
  EXPECT_EQ(by_64.film, by_32.film);
  EXPECT_EQ(by_64.counters.total(), by_32.counters.total());
}

// The forms for CPUs of the same picture: all stages in one launch, by each of the walks.
TEST_P(FeaturesTest, OneLaunchOfTheBinaryWalk) {
  expect_the_same_in_one_launch(Traversal::binary);
}
TEST_P(FeaturesTest, OneLaunchOfTheWideWalk) {
  expect_the_same_in_one_launch(Traversal::wide);
}
TEST_P(FeaturesTest, OneLaunchOfPackets) {
  expect_the_same_in_one_launch(Traversal::packet);
}
TEST_P(FeaturesTest, OneLaunchOfBatches) {
  expect_the_same_in_one_launch(Traversal::batch);
}
TEST_P(FeaturesTest, OneLaunchOfAllWalks) {
  expect_the_same_in_one_launch(Traversal::automatic);
}

// Buffers are as large as the scene's own features make them, so that Oclgrind sees what is out of bounds.
TEST_P(FeaturesTest, EverythingStageByStage) {
  expect_the_same_with_everything(
      {0, kT, kT | kReflect, kT | kSmooth | kLit, KDRAY_FEATURE_KIND(SPHERE) | kTransmit | kLit, kBackground},
      kByStages);
}
TEST_P(FeaturesTest, EverythingInOneLaunch) {
  Schedule fused = kByStages;
  fused.fused = true;
  // One program that has everything serves all of these, but one is compiled for ten seconds for each way in
  // which rays are made or looks are read.
  const auto has_own_rays = [](layout::Features mask) { return has(mask, kSamples | kArea | kLens); };
  for (auto masks : {geometry_masks(), materials_masks(), kLightsMasks, kFilmMasks}) {
    std::erase_if(masks, has_own_rays);
    expect_the_same_with_everything(masks, fused);
  }
  expect_the_same_with_everything({kT | kSmooth | kLit | kMaps | kTextures, kTexturingMasks.back(),
                                   kT | kLit | kArea | kFallOff | kSamples, kT | kLit | kLens},
                                  fused);
}

// NaN of both signs, infinity, small and large numbers, indices far outside of any array.
TEST_P(FeaturesTest, FreshMemoryDoesNotShow) {
  Subject subject(context_, kAll);
  for (const bool fused : {false, true}) {
    Schedule schedule = kByStages;
    schedule.fused = fused;
    const RenderedFrame zeros = subject.draw(schedule);
    for (const cl_uint word :
         {0xffffffffu, 0x7fc00001u, 0x7f800000u, 0x3f800000u, 0x7f7fffffu, 0x00000001u}) {
      SCOPED_TRACE(fmt::format("{} {:#010x}", fused ? "one launch" : "stages", word));
      schedule.fill = word;
      const RenderedFrame other = subject.draw(schedule);
      EXPECT_EQ(other.film, zeros.film);
      EXPECT_EQ(other.counters.total(), zeros.counters.total());
    }
  }
}

TEST_P(FeaturesTest, Channels) {
  for (const image::Channel& channel : Subject(context_, kAll).channels()) {
    EXPECT_EQ(channel.values.size(), 63u) << channel.name;
    EXPECT_TRUE(std::ranges::none_of(channel.values, [](float v) { return std::isnan(v); })) << channel.name;
  }
}

KDRAY_FOR_EACH_DEVICE(FeaturesTest);

}  // namespace
}  // namespace kdray::wavefront
