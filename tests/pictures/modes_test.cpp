// What    The same picture, bit for bit, and the same rays, whichever way the frame is divided among the
//         queues: PDPRT, ODPRT by each balance, buffers of any size, a device that holds a part of the scene,
//         queues that fail.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pictures/render.h"
#include "pictures/scenes.h"
#include "support/errors.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 150, kHeight = 101;  // no multiple of any tile

struct Way {
  std::string name;
  int queues = 1;
  RenderOptions options = exact_options(kWidth, kHeight);
  std::string faults = {};
  kdray::Schedule schedule = kdray::Schedule::automatic;
};

Way odprt(int queues, Balance balance, const std::string& more = "") {
  Way way{fmt::format("odprt, {} queues, balance {}{}", queues, static_cast<int>(balance), more), queues};
  way.options.mode = Mode::odprt;
  way.options.balance = balance;
  return way;
}

// Every ray has a work-item, as on GPUs.
Way per_ray(Way way) {
  way.name += ", a work-item for each ray";
  way.schedule = kdray::Schedule::global;
  return way;
}

struct Shot {
  Picture picture;
  nlohmann::json statistics;
};

Shot render(const Scene& scene, const Way& way) {
  DeviceOptions device;
  device.queues = way.queues;
  device.schedule = way.schedule;
  Renderer renderer = api::make_renderer(scene, {}, device_of(device), {.faults = way.faults});
  Picture picture = renderer.render(way.options);
  return {std::move(picture), statistics_of(renderer)};
}

class Modes : public testing::TestWithParam<NamedScene> {
 protected:
  const Scene scene{GetParam().make()};
  const Shot first = render(scene, {"pdprt", 1});

  void expect_same(const Way& way) {
    const Shot other = render(scene, way);
    EXPECT_TRUE(same_bits(first.picture.rgb, other.picture.rgb)) << way.name;
    for (const char* const kind : {"primary", "primary_hit", "shadow", "reflected", "refracted", "total"})
      EXPECT_EQ(first.statistics["rays"][kind], other.statistics["rays"][kind]) << way.name << ": " << kind;
  }
};

TEST_P(Modes, OdprtByQueuesAndBalance) {
  ASSERT_GT(mean_luminance(first.picture), 0.05);
  for (const int queues : {1, 2, 3, 8})
    for (const Balance balance : {Balance::sah, Balance::pilot}) expect_same(odprt(queues, balance));
}

// With five queues the host sorts the rays.
TEST_P(Modes, OdprtWithAWorkItemForEachRay) {
  for (const int queues : {1, 2, 5}) expect_same(per_ray(odprt(queues, Balance::pilot)));
  const Shot shot = render(scene, per_ray(odprt(1, Balance::sah)));
  EXPECT_EQ(shot.statistics["mode"]["schedule"], "global");
  Way failing = per_ray(odprt(3, Balance::sah));
  failing.faults = "1@1";
  EXPECT_TRUE(same_bits(first.picture.rgb, render(scene, failing).picture.rgb));
}

TEST_P(Modes, OdprtWithTinyBuffers) {
  for (const int rays : {1, 5, 100}) {
    Way way = odprt(3, Balance::sah, fmt::format(", buffers of {}", rays));
    way.options = exact_options(40, 31);
    way.options.mode = Mode::odprt;
    way.options.ray_buffer = rays;
    way.options.tile_width = way.options.tile_height = 8;
    Way plain{"pdprt"};
    plain.options = exact_options(40, 31);
    const Shot expected = render(scene, plain), got = render(scene, way);
    EXPECT_TRUE(same_bits(expected.picture.rgb, got.picture.rgb)) << way.name;
    EXPECT_EQ(expected.statistics["rays"], got.statistics["rays"]) << way.name;
    if (rays < 100) continue;
    const Shot each = render(scene, per_ray(way));
    EXPECT_TRUE(same_bits(expected.picture.rgb, each.picture.rgb)) << way.name;
    EXPECT_EQ(expected.statistics["rays"], each.statistics["rays"]) << way.name;
  }
}

TEST_P(Modes, OdprtWithQueuesThatFail) {
  for (const char* const faults : {"0@1", "2@1", "0@1,1@1"}) {
    Way way = odprt(3, Balance::sah, fmt::format(", faults {}", faults));
    way.faults = faults;
    const Shot got = render(scene, way);
    EXPECT_TRUE(same_bits(first.picture.rgb, got.picture.rgb)) << way.name;
    EXPECT_EQ(first.statistics["rays"], got.statistics["rays"]) << way.name;
    EXPECT_EQ(got.statistics["mode"]["quarantined"].size(), got.picture.warnings.size());
    EXPECT_GE(got.picture.warnings.size(), 1u) << way.name;
  }
}

// What `part` of the whole's values is, of so many to a pixel.
std::vector<float> part_of(const std::vector<float>& whole, int values, const PixelRect& part) {
  std::vector<float> cut;
  for (int y = part.y; y < part.y + part.height; ++y) {
    const auto first = whole.begin() + std::ptrdiff_t{values} * (y * kWidth + part.x);
    cut.insert(cut.end(), first, first + std::ptrdiff_t{values} * part.width);
  }
  return cut;
}

TEST_P(Modes, APartHasTheWholePicturesPixels) {
  Way whole{"pdprt", 1};
  whole.options.samples = 3;
  whole.options.channels = {"depth", "normal", "primitive"};
  const Picture expected = render(scene, whole).picture;
  for (const PixelRect part : {PixelRect{37, 22, 70, 41}, PixelRect{149, 0, 1, 101}, PixelRect{0, 90, 3, 1}})
    for (Way way : {whole, per_ray(whole), odprt(2, Balance::pilot), per_ray(odprt(3, Balance::sah))}) {
      SCOPED_TRACE(way.name);
      way.options.samples = whole.options.samples;
      way.options.channels = whole.options.channels;
      way.options.crop = part;
      const Picture got = render(scene, way).picture;
      ASSERT_EQ(std::pair(got.width, got.height), std::pair(part.width, part.height));
      EXPECT_EQ(std::pair(got.x, got.y), std::pair(part.x, part.y));
      EXPECT_EQ(std::pair(got.whole_width, got.whole_height), std::pair(kWidth, kHeight));
      EXPECT_TRUE(same_bits(got.rgb, part_of(expected.rgb, 3, part)));
      for (const char* const name : {"depth", "normal.x", "normal.z", "primitive"})
        EXPECT_TRUE(same_bits(channel(got, name), part_of(channel(expected, name), 1, part))) << name;
    }
}

TEST_P(Modes, OdprtThatFailsEverywhereSaysSo) {
  Way way = odprt(2, Balance::sah);
  way.faults = "0@1,1@1";
  try {
    render(scene, way);
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::no_device) << e.what();
  }
}

TEST_P(Modes, OdprtGoesOnWhereAQueueHasTooLittleMemory) {
  Way way = odprt(3, Balance::sah);
  way.faults = "1@1:memory";
  const Shot got = render(scene, way);
  EXPECT_TRUE(same_bits(first.picture.rgb, got.picture.rgb));
  ASSERT_EQ(got.picture.warnings.size(), 1u);
  EXPECT_NE(got.picture.warnings[0].find("memory does not suffice"), std::string::npos)
      << got.picture.warnings[0];
  way.faults = "0@1:memory,1@1:memory,2@1:memory";
  EXPECT_TRUE(fails([&] { render(scene, way); }, "memory does not suffice", ErrorCode::out_of_memory));
}

// No queue is left out: the next would do the same.
TEST_P(Modes, OdprtEndsWithABugOrAnErrorOfKdraysOwn) {
  Way way = odprt(2, Balance::sah);
  way.faults = "1@1:bug";
  EXPECT_TRUE(fails([&] { render(scene, way); }, "this is a fault of kdray", ErrorCode::internal));
  way.faults = "1@1:input";
  EXPECT_TRUE(fails([&] { render(scene, way); }, "fault on purpose", ErrorCode::input));
}

TEST_P(Modes, ASequenceOfFramesThatMovesSubtrees) {
  DeviceOptions device;
  device.queues = 3;
  Renderer renderer(scene, {}, device_of(device));
  Way way = odprt(3, Balance::dynamic);
  for (int frame = 0; frame < 4; ++frame)
    EXPECT_TRUE(same_bits(first.picture.rgb, renderer.render(way.options).rgb)) << "frame " << frame;
}

// All else here is by the automatic walk, which has the code of the others: these by themselves, for which a
// program is compiled for seconds, in two scenes that have the most between them.
class AnyWalk : public Modes {};

TEST_P(AnyWalk, GivesTheSameInOdprt) {
  for (const Traversal walk : {Traversal::wide, Traversal::packet, Traversal::batch}) {
    Way way = odprt(2, Balance::sah, fmt::format(", walk {}", static_cast<int>(walk)));
    way.options.traversal = walk;
    expect_same(way);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Modes, testing::ValuesIn(small_scenes()),
                         [](const auto& info) { return info.param.name; });
INSTANTIATE_TEST_SUITE_P(Textured, Modes,
                         testing::Values(NamedScene{"textured", textured}, NamedScene{"mapped", mapped},
                                         NamedScene{"soft_light", soft_light},
                                         NamedScene{"under_a_sky", under_a_sky},
                                         NamedScene{"instanced", instanced},
                                         NamedScene{"instanced_maps", instanced_maps}),
                         [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(Modes, AnyWalk,
                         testing::Values(NamedScene{"every_kind", every_kind},
                                         NamedScene{"instanced_maps", instanced_maps}),
                         [](const auto& info) { return info.param.name; });

scene::Scene nothing() {
  scene::Scene s;
  s.background = vec3(0.25f, 0.5f, 0.75f);
  s.camera = scene::Camera{};
  return s;
}

TEST(Odprt, AnEmptySceneIsItsBackground) {
  const Scene scene{nothing()};
  const Shot pdprt = render(scene, {"pdprt"}), got = render(scene, odprt(4, Balance::pilot));
  EXPECT_TRUE(same_bits(pdprt.picture.rgb, got.picture.rgb));
  EXPECT_FLOAT_EQ(got.picture.rgb[2], 0.75f);
}

TEST(Odprt, QueuesHoldTheirPartsOnly) {
  const Scene scene{smooth_meshes()};
  const Shot shot = render(scene, odprt(2, Balance::pilot));
  const auto whole = shot.statistics["mode"]["whole_geometry_bytes"].get<double>();
  ASSERT_EQ(shot.statistics["memory"]["per_queue"].size(), 2u);
  double sum = 0;
  for (const auto& queue : shot.statistics["memory"]["per_queue"]) {
    EXPECT_LE(queue["geometry_bytes"].get<double>(), 0.7 * whole);
    sum += queue["geometry_bytes"].get<double>();
  }
  EXPECT_GE(sum, whole);
}

TEST(Odprt, RaysTravel) {
  const Scene scene{glass_and_mirror_balls()};
  const Shot shot = render(scene, odprt(2, Balance::pilot));
  const auto& mode = shot.statistics["mode"];
  EXPECT_GT(mode["exchange"]["rays"][0][1].get<int>(), 100);
  EXPECT_GT(mode["exchange"]["rays"][1][0].get<int>(), 100);
  EXPECT_EQ(mode["exchange"]["rays"][0][0].get<int>(), 0) << "a queue sent rays to itself";
  std::uint64_t in = 0, out = 0;
  for (const auto& queue : mode["per_queue"])
    in += queue["rays_in"].get<int>(), out += queue["rays_out"].get<int>();
  EXPECT_EQ(in, out);
}

TEST(Odprt, TheBinaryTreeIsRefused) {
  Way way = odprt(1, Balance::sah);
  way.options.traversal = Traversal::binary;
  try {
    render(Scene{smooth_meshes()}, way);
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
  }
}

// A mesh that a device's memory holds a small part of.
scene::Scene many_triangles() {
  scene::Scene s = smooth_meshes();
  for (int i = 0; i < 12; ++i)
    add_smooth_ball(s, dvec3(i % 4 - 1.5, i / 4 - 1.0, -2.0), 0.45, 90,
                    s.materials[static_cast<std::size_t>(i) % s.materials.size()]);
  return s;
}

TEST(Odprt, LessMemoryThanTheSceneTakes) {
  const Scene scene{many_triangles()};
  const Shot whole = render(scene, {"pdprt"});
  std::vector<Way> ways = {odprt(1, Balance::sah), odprt(2, Balance::sah), per_ray(odprt(2, Balance::sah))};
  for (Way& way : ways) {
    const int queues = way.queues;
    way.options.device_memory = std::uint64_t{60} << 20;
    const Shot got = render(scene, way);
    EXPECT_TRUE(same_bits(whole.picture.rgb, got.picture.rgb)) << queues;
    EXPECT_EQ(whole.statistics["rays"], got.statistics["rays"]) << queues;
    EXPECT_GT(got.statistics["mode"]["parts"].get<int>(), queues);
    std::uint64_t held = 0;
    for (const auto& queue : got.statistics["memory"]["per_queue"])
      held += queue["geometry_bytes"].get<std::uint64_t>() + queue["work_bytes"].get<std::uint64_t>();
    EXPECT_LE(held, way.options.device_memory);
    EXPECT_GT(got.statistics["mode"]["whole_geometry_bytes"].get<std::uint64_t>(), way.options.device_memory);
  }
}

// Parts come and go, few rays have room on the way (so that each change of parts serves few), and a queue
// fails.
TEST(Odprt, LessMemoryTinyBuffersAndAFault) {
  const Scene scene{many_triangles()};
  Way plain{"pdprt"};
  plain.options = exact_options(16, 12);
  const Shot expected = render(scene, plain);
  for (const int rays : {7, 100}) {
    Way way{fmt::format("buffers of {}", rays), 3, plain.options, "1@2"};
    way.options.mode = Mode::odprt;
    way.options.balance = Balance::sah;
    way.options.ray_buffer = rays;
    way.options.tile_width = way.options.tile_height = 4;
    way.options.device_memory = std::uint64_t{60} << 20;
    const Shot got = render(scene, way);
    EXPECT_TRUE(same_bits(expected.picture.rgb, got.picture.rgb)) << way.name;
    EXPECT_EQ(expected.statistics["rays"], got.statistics["rays"]) << way.name;
    EXPECT_GT(got.statistics["mode"]["parts"], 3) << way.name;
    EXPECT_EQ(got.statistics["mode"]["quarantined"].size(), 1u) << way.name;
  }
}

// A limit that all parts fit in together, just so: they stay, and keep to it.
TEST(Odprt, PartsThatStayKeepToTheLimit) {
  const Scene scene{many_triangles()};
  for (const int queues : {2, 4}) {
    Way way = odprt(queues, Balance::pilot, ", limited");
    const Shot free = render(scene, way);
    std::uint64_t work = 0;
    for (const auto& queue : free.statistics["memory"]["per_queue"])
      work += queue["work_bytes"].get<std::uint64_t>();
    const auto geometry = free.statistics["mode"]["whole_geometry_bytes"].get<double>();
    way.options.device_memory = work + static_cast<std::uint64_t>(1.35 * geometry);
    const Shot got = render(scene, way);
    EXPECT_TRUE(same_bits(free.picture.rgb, got.picture.rgb)) << queues;
    EXPECT_EQ(got.statistics["mode"]["parts"], queues);
    std::uint64_t held = 0;
    for (const auto& queue : got.statistics["memory"]["per_queue"])
      held += queue["geometry_bytes"].get<std::uint64_t>() + queue["work_bytes"].get<std::uint64_t>();
    EXPECT_LE(held, way.options.device_memory) << queues;
  }
}

TEST(ModeAuto, TakesWhatFitsAndSaysWhy) {
  const Scene scene{smooth_meshes()};
  Way way{"auto", 2};
  const Shot fits = render(scene, way);
  EXPECT_EQ(fits.statistics["mode"]["name"], "pdprt");
  EXPECT_NE(fits.statistics["mode"]["why"].get<std::string>().find("fits"), std::string::npos);
}

}  // namespace
}  // namespace kdray::test
