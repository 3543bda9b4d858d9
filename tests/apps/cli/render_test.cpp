// What    kdray render through the real program: pictures, statistics, defaults, and what is refused.
#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "io/image/picture_file.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

image::Image read(const fs::path& file) {
  return image::read_picture(file, {});
}

TEST(RenderCommand, WritesAPictureNamedAfterTheSceneInTheCurrentFolder) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  fs::create_directory(folder / "scenes");
  folder.put("scenes/ball.nff", kSphereOnSquare);
  const Outcome run = kdray({"render", "scenes/ball.nff"}, {.folder = folder.path()});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(run.out.empty()) << run.out;
  EXPECT_NE(run.err.find("ball.png"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("Mrays/s"), std::string::npos) << run.err;
  const image::Image picture = read(folder / "ball.png");
  EXPECT_EQ(picture.width, 48);
  EXPECT_EQ(picture.height, 32);
  EXPECT_EQ(folder.n_entries(), 2u);  // nothing is left beside the picture
}

TEST(RenderCommand, TheSameOptionsInBothFormatsGiveTheSamePicture) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"render", scene, "--size=40x30", "-o", folder / "a.exr", "-q"})));
  ASSERT_TRUE(
      succeeds(kdray({"render", scene, "--size", "40x30", "-o", folder / "b.png", "--bits", "16", "-q"})));
  const image::Image exr = read(folder / "a.exr"), png = read(folder / "b.png");
  ASSERT_EQ(exr.pixels.size(), 1200u);
  ASSERT_EQ(png.pixels.size(), 1200u);
  for (std::size_t i = 0; i < exr.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(png.pixels[i][c], std::min(exr.pixels[i][c], 1.0f), 3e-5f) << "pixel " << i;
  // The sky's colour is the background exactly: the picture is upright, with the sky in its first row.
  EXPECT_FLOAT_EQ(exr.pixels[0].x, 0.1f);
  EXPECT_FLOAT_EQ(exr.pixels[0].z, 0.4f);
  EXPECT_NE(exr.pixels.back().z, 0.4f);
}

TEST(RenderCommand, APartOfAPictureIsThatPart) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const auto made = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render",      scene,          "--size",     "40x30",
                                       "-q",          "--samples",    "4",          "-o",
                                       folder / name, "--background", "transparent"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_TRUE(succeeds(kdray(arguments)));
    return read(folder / name);
  };
  const image::Image whole = made("whole.exr", {}), part = made("part.exr", {"--crop", "15x9+20+8"});
  ASSERT_EQ(std::pair(part.width, part.height), std::pair(15, 9));
  ASSERT_EQ(part.alpha.size(), part.pixels.size());
  for (std::size_t y = 0; y < 9; ++y)
    for (std::size_t x = 0; x < 15; ++x) {
      const std::size_t at = y * 15 + x, there = (y + 8) * 40 + x + 20;
      EXPECT_EQ(part.pixels[at], whole.pixels[there]) << x << ", " << y;
      EXPECT_EQ(part.alpha[at], whole.alpha[there]) << x << ", " << y;
    }
  EXPECT_TRUE(
      fails_with(kdray({"render", scene, "--size", "40x30", "--crop", "15x9+30+8", "-o", folder / "a.png"}),
                 2, "the part 15x9+30+8 does not lie within the picture of 40x30"));
  EXPECT_FALSE(fs::exists(folder / "a.png"));
}

TEST(RenderCommand, AWidthAloneKeepsTheAspectRatioOfTheScene) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto height = [&](const fs::path& scene) {
    EXPECT_TRUE(
        succeeds(kdray({"render", scene, "--size", "24", "--samples", "1", "-q", "-o", folder / "a.png"})));
    const image::Image picture = read(folder / "a.png");
    EXPECT_EQ(picture.width, 24);
    return picture.height;
  };
  EXPECT_EQ(height(folder.put("ball.nff", kSphereOnSquare)), 16) << "its resolution is 48x32";
  EXPECT_EQ(height(folder.put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), 24);
  EXPECT_TRUE(
      fails_with(kdray({"render", folder / "ball.nff", "--size", "24x"}), 2, "WIDTHxHEIGHT or WIDTH"));
}

TEST(RenderCommand, AnExrNamesThePartsThatItsPrimitivesAreOf) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", face = "f 1 2 3\n";
  const fs::path scene =
      folder.put("a.obj", corners + "o lid\n" + face + face + "o box\n" + face + "o lid\n" + face);
  ASSERT_TRUE(succeeds(
      kdray({"render", scene, "--size", "8x8", "--aov", "primitive,depth", "-q", "-o", folder / "a.exr"})));
  const std::string bytes = folder.get("a.exr");
  EXPECT_NE(bytes.find("kdray/primitive/manifest"), std::string::npos);
  EXPECT_NE(bytes.find(R"({"lid":[[0,2],[3,1]],"box":[[2,1]]})"), std::string::npos);
}

TEST(RenderCommand, TheSummaryIsOneLineAndTheRestIsToldWhenAskedFor) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.png"})));  // kernels are built from here on
  const auto lines = [&](const std::string& option) {
    const Outcome run = kdray({"render", scene, "-o", folder / "a.png", option});
    EXPECT_TRUE(succeeds(run));
    const std::string err = without_notice(run.err);
    return std::count(err.begin(), err.end(), '\n') - (err.find("a first start") != std::string::npos);
  };
  EXPECT_EQ(lines("--depth=3"), 1);
  EXPECT_GE(lines("--verbose"), 4);
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-v", "-q"}), 2, "--quiet"));
}

// Six panes of clear glass before a white wall: an eye ray crosses them in depths 1 to 6.
TEST(RenderCommand, StackedGlassIsToldWhichDepthItNeeds) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  std::string text = "v\nfrom 0 0 9\nat 0 0 0\nup 0 1 0\nangle 30\nresolution 32 32\nf 1 1 1 0 0 1 0.9 1\n";
  for (int z = 1; z <= 6; ++z) {
    const std::string at = " " + std::to_string(z) + "\n";
    text += "p 4\n-9 -9" + at + "9 -9" + at + "9 9" + at + "-9 9" + at;
  }
  const fs::path scene =
      folder.put("panes.nff", text + "f 1 1 1 1 0 1 0 1\np 4\n-9 -9 0\n9 -9 0\n9 9 0\n-9 9 0\n");
  const auto hint = [&](const fs::path& file, const char* depth) {
    const Outcome run = kdray({"render", file, "-o", folder / "a.png", "--depth", depth});
    EXPECT_TRUE(succeeds(run));
    const std::size_t at = run.err.find("try --depth ");
    return at == std::string::npos ? "" : run.err.substr(at, run.err.find('\n', at) - at);
  };
  EXPECT_EQ(hint(scene, "4"), "try --depth 8");
  EXPECT_EQ(hint(scene, "7"), "");
  // A ball's inner reflections are cut off too, but don't matter.
  const fs::path ball =
      folder.put("ball.nff",
                 "v\nfrom 0 0 9\nat 0 0 0\nup 0 1 0\nangle 30\nresolution 32 32\nb 0.5 0.5 0.5\n"
                 "f 1 1 1 0 0.05 1 0.9 1.5\ns 0 0 0 1\n");
  EXPECT_EQ(hint(ball, "4"), "");
  // Mirrors are no glass.
  const fs::path mirrors =
      folder.put("mirrors.nff",
                 "v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle 30\nresolution 32 32\nf 1 1 1 0 0.9 1 0 1\n"
                 "p 4\n-9 -9 0\n9 -9 0\n9 9 0\n-9 9 0\np 4\n-9 -9 2\n9 -9 2\n9 9 2\n-9 9 2\n");
  EXPECT_EQ(hint(mirrors, "4"), "");
}

TEST(RenderCommand, QuietIsSilent) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const Outcome run = kdray({"render", scene, "-o", folder / "a.png", "--quiet"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(run.out.empty() && run.err.empty()) << run.out << run.err;
}

TEST(RenderCommand, StatisticsHoldWhatIsPromised) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.png", "--stats", folder / "s.json"})));
  const Json stats = Json::parse(folder.get("s.json"));
  double parts = 0;
  for (const char* const stage :
       {"load", "build", "flatten", "upload", "compile", "trace", "shade", "render", "write", "total"}) {
    ASSERT_TRUE(stats["seconds"][stage].is_number()) << stage;
    EXPECT_GE(stats["seconds"][stage], 0.0) << stage;
  }
  for (const char* const stage : {"load", "build", "flatten", "upload", "render", "write"})
    parts += stats["seconds"][stage].get<double>();
  EXPECT_LE(parts, stats["seconds"]["total"]);
  const Json& rays = stats["rays"];
  EXPECT_EQ(rays["primary"], 48 * 32);
  EXPECT_EQ(rays["total"].get<long>(), rays["primary"].get<long>() + rays["shadow"].get<long>() +
                                           rays["reflected"].get<long>() + rays["refracted"].get<long>());
  EXPECT_GT(rays["shadow"], 0);
  EXPECT_GT(rays["reflected"], 0);
  EXPECT_EQ(rays["refracted"], 0);
  EXPECT_TRUE(rays["skipped"].is_object());
  EXPECT_GT(stats["mrays_per_s"], 0.0);
  for (const char* const object : {"tree", "memory", "device", "mode"})
    EXPECT_FALSE(stats[object].empty()) << object;
  EXPECT_FALSE(stats["features"]["on"].empty());
  EXPECT_FALSE(stats["features"]["off"].empty());
  EXPECT_GT(stats["memory"]["process_peak_bytes"], 1 << 20);
}

TEST(RenderCommand, StatisticsGoToStdoutAsDash) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const Outcome run = kdray({"render", scene, "-o", folder / "a.png", "--stats", "-", "-q"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_EQ(Json::parse(run.out)["command"], "render");
  EXPECT_EQ(folder.n_entries(), 2u);
}

TEST(RenderCommand, ChannelsComeBesideThePicture) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(
      succeeds(kdray({"render", scene, "-o", folder / "a.png", "--aov", "depth,normal,primitive,cost"})));
  for (const char* const name : {"a.png", "a.depth.png", "a.normal.png", "a.primitive.png", "a.cost.png"})
    EXPECT_EQ(read(folder / name).pixels.size(), 48u * 32u) << name;
}

TEST(RenderCommand, EveryScheduleGivesTheSameBytes) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.exr", "-q"})));
  const std::vector<std::vector<std::string>> schedules = {
      {"--tile", "7x3"},
      {"--work-group", "16"},
      {"--mode", "pdprt", "--traversal", "binary"},
      {"--queues", "3", "--division", "bag"},
      {"--queues", "2", "--division", "contiguous"},
      {"--queues", "8", "--division", "interleaved", "--tile", "5x5"}};
  for (std::vector<std::string> arguments : schedules) {
    for (const char* const more : {"render", "-q", "-o"}) arguments.push_back(more);
    std::rotate(arguments.begin(), arguments.end() - 3, arguments.end() - 2);  // "render" first
    arguments.push_back(folder / "b.exr");
    arguments.push_back(scene);
    ASSERT_TRUE(succeeds(kdray(arguments))) << arguments[1];
    EXPECT_EQ(folder.get("a.exr"), folder.get("b.exr")) << arguments[1];
  }
}

// PoCL makes as many devices as it is told to.
const RunOptions kTwoDevices = {.environment = {{"POCL_DEVICES", "pthread basic"}}};

// Into a.exr; false where there is no such device.
bool draws_on_second_device(const Folder& folder, const fs::path& scene) {
  return kdray({"render", scene, "-o", folder / "a.exr", "--device", "1"}, kTwoDevices).code != 3;
}

TEST(RenderCommand, SeveralDevicesShareAFrame) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  if (!draws_on_second_device(folder, scene)) GTEST_SKIP() << "PoCL gives no second device";
  for (const char* const queues : {"1", "3", "8"}) {
    ASSERT_TRUE(
        succeeds(kdray({"render", scene, "-o", folder / "b.exr", "--device", "0,1", "--queues", queues,
                        "--division", "interleaved", "--tile", "4x4", "--stats", folder / "s.json"},
                       kTwoDevices)));
    EXPECT_EQ(folder.get("a.exr"), folder.get("b.exr"));
    const Json mode = Json::parse(folder.get("s.json"))["mode"];
    EXPECT_EQ(mode["queues"], std::max(std::stoi(queues), 2));
    ASSERT_EQ(mode["devices"].size(), 2u);
    EXPECT_NE(mode["devices"][0], mode["devices"][1]);
    for (const Json& queue : mode["per_queue"]) {
      EXPECT_EQ(queue["device"], mode["devices"][queue["queue"].get<std::size_t>() % 2]);
      EXPECT_GT(queue["tiles"], 0);
    }
  }
}

// Rays go from one device to the other by the host's memory.
TEST(RenderCommand, SeveralDevicesShareAScene) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  if (!draws_on_second_device(folder, scene)) GTEST_SKIP() << "PoCL gives no second device";
  for (const char* const queues : {"2", "5"}) {
    ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "b.exr", "--device", "0,1", "--queues",
                                queues, "--mode", "odprt", "--tile", "4x4", "--stats", folder / "s.json"},
                               kTwoDevices)));
    EXPECT_EQ(folder.get("a.exr"), folder.get("b.exr"));
    const Json mode = Json::parse(folder.get("s.json"))["mode"];
    EXPECT_EQ(mode["name"], "odprt");
    EXPECT_EQ(mode["per_queue"].size(), std::stoul(queues));
    EXPECT_GT(mode["exchange"]["rays_total"], 0);
  }
}

TEST(RenderCommand, OdprtTellsOfItsQueues) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.exr", "-q"})));
  ASSERT_TRUE(succeeds(
      kdray({"render", scene, "-o", folder / "b.exr", "--mode", "odprt", "--queues", "2", "--balance", "sah",
             "--tile", "8x8", "--trace", folder / "t.json", "--stats", folder / "s.json", "-q"})));
  EXPECT_EQ(folder.get("a.exr"), folder.get("b.exr"));
  const Json stats = Json::parse(folder.get("s.json")), timeline = Json::parse(folder.get("t.json"));
  std::map<int, double> rays, ends;
  for (const Json& event : timeline["traceEvents"]) {
    if (event["ph"] != "X") continue;
    const int row = event["tid"];
    rays[row] += event["args"]["rays"].get<double>();
    EXPECT_GE(event["ts"].get<double>(), ends[row]) << "launches of a queue overlap";
    ends[row] = event["ts"].get<double>() + event["dur"].get<double>();
  }
  for (const Json& queue : stats["mode"]["per_queue"])
    EXPECT_EQ(queue["rays"].get<double>(), rays[queue["queue"].get<int>()]);
  EXPECT_EQ(stats["rays"]["primary"], 48 * 32);
  EXPECT_TRUE(stats["seconds"].contains("divide"));
}

TEST(RenderCommand, AQueueThatFailsCostsAWarningAndNothingElse) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.exr", "-q"})));
  const std::vector<std::string> arguments = {
      "render",     scene,    "-o",  folder / "b.exr", "--queues", "2",       "--division",
      "contiguous", "--tile", "4x4", "--inject-fault", "1@1",      "--stats", folder / "s.json"};
  const Outcome run = kdray(arguments);
  ASSERT_TRUE(succeeds(run));
  EXPECT_EQ(folder.get("a.exr"), folder.get("b.exr"));
  EXPECT_NE(run.err.find("queue 1"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("fault on purpose"), std::string::npos) << run.err;
  const Json stats = Json::parse(folder.get("s.json"));
  ASSERT_EQ(stats["mode"]["quarantined"].size(), 1u);
  EXPECT_EQ(stats["mode"]["quarantined"][0]["queue"], 1);
  EXPECT_EQ(stats["rays"]["primary"], 48 * 32);
  EXPECT_EQ(stats["mode"]["per_queue"][0]["tiles"], stats["mode"]["tiles"]);
}

TEST(RenderCommand, DeviceMemoryIsKeptInEveryMode) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const auto run = [&](const std::string& mode, const std::string& limit) {
    return kdray({"render", scene, "-o", folder / "a.png", "--size", "600x600", "--mode", mode,
                  "--device-memory", limit, "--stats", folder / "s.json", "-q"});
  };
  const auto holds = [&](const char* mode, std::uint64_t megabytes) {
    const Json stats = Json::parse(folder.get("s.json"));
    EXPECT_EQ(stats["mode"]["name"], mode);
    const Json& queue = stats["memory"]["per_queue"][0];
    EXPECT_LE(queue["work_bytes"].get<std::uint64_t>() + queue["geometry_bytes"].get<std::uint64_t>(),
              megabytes << 20);
  };
  EXPECT_TRUE(fails_with(run("pdprt", "1M"), 4, "too little for pdprt"));
  ASSERT_TRUE(succeeds(run("pdprt", "64M")));
  holds("pdprt", 64);
  ASSERT_TRUE(succeeds(run("auto", "12M")));
  holds("odprt", 12);
}

TEST(RenderCommand, WhenEveryQueueFailsThereIsNoPicture) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", folder / "a.png", "--queues", "2", "--division",
                                "contiguous", "--inject-fault", "0@1,1@2", "-q"}),
                         3, "fault on purpose"));
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(RenderCommand, ABugIsToldAsKdraysInBothModes) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  for (const std::string mode : {"pdprt", "odprt"}) {
    const Outcome run = kdray({"render", scene, "-o", folder / "a.png", "--queues", "2", "--mode", mode,
                               "--division", "contiguous", "--inject-fault", "1@1:bug", "-q"});
    EXPECT_TRUE(fails_with(run, 1, "this is a fault of kdray, please report this line"));
    EXPECT_EQ(run.err.find("doctor"), std::string::npos) << run.err;
    EXPECT_EQ(folder.n_entries(), 1u);
  }
}

TEST(RenderCommand, TheTimelineHasARowForEachQueue) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(
      succeeds(kdray({"render", scene, "-o", folder / "a.png", "--queues", "2", "--division", "interleaved",
                      "--tile", "8x8", "--trace", folder / "t.json", "--stats", folder / "s.json", "-q"})));
  const Json stats = Json::parse(folder.get("s.json"));
  std::map<int, std::string> rows;
  std::map<int, double> tiles;
  const Json timeline = Json::parse(folder.get("t.json"));
  for (const Json& event : timeline["traceEvents"]) {
    const int row = event["tid"];
    if (event["ph"] == "M") rows[row] = event["args"]["name"];
    if (event["ph"] == "X") tiles[row] += event["args"]["tiles"].get<double>();
  }
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].rfind("queue 0: ", 0), 0u) << rows[0];
  EXPECT_EQ(tiles[0], 12);
  EXPECT_EQ(tiles[1], 12);
  const Json& mode = stats["mode"];
  EXPECT_EQ(mode["tile"], Json({8, 8}));
  if (mode.contains("tile_seconds")) {  // where the device counts cycles
    EXPECT_EQ(mode["tile_seconds"].size(), 24u);
  }
  for (const Json& queue : stats["memory"]["per_queue"]) {
    EXPECT_EQ(queue["geometry_bytes"], stats["memory"]["scene_bytes"]);
    EXPECT_GT(queue["work_bytes"], 48 * 16 * 24);
  }
}

TEST(RenderCommand, WhatCannotBeWrittenIsRefusedBeforeTheSceneIsRead) {
  const Folder folder;
  fs::create_directory(folder / "folder.png");
  folder.put("file", "");
  // The scene does not exist: a message about it would mean that it was looked for first.
  const auto refuses = [&](const std::string& output, const std::string& text) {
    return fails_with(kdray({"render", "no-such-scene.nff", "-o", output}, {.folder = folder.path()}), 1,
                      text);
  };
  EXPECT_TRUE(refuses("missing/a.png", "missing"));
  EXPECT_TRUE(refuses("file/a.png", "file"));
  EXPECT_TRUE(refuses("a.jpg", ".png or .exr"));
  EXPECT_TRUE(refuses("a", ".png or .exr"));
  EXPECT_TRUE(refuses("folder.png", "is a folder"));
  EXPECT_TRUE(fails_with(
      kdray({"render", "no-such-scene.nff", "--stats", "missing/s.json"}, {.folder = folder.path()}), 1,
      "missing"));
  EXPECT_EQ(folder.n_entries(), 2u);
}

TEST(RenderCommand, FilesThatWouldDestroyEachOtherAreRefused) {
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  EXPECT_TRUE(fails_with(kdray({"render", scene, "--stats", scene, "-o", folder / "a.png"}), 2, "same file"));
  EXPECT_TRUE(fails_with(
      kdray({"render", "ball.nff", "--stats", "./a.png", "-o", "a.png"}, {.folder = folder.path()}), 2,
      "same file"));
  EXPECT_EQ(folder.get("ball.nff"), kSphereOnSquare);
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(RenderCommand, AFaultySceneIsNamedWithItsLineAndLeavesNothing) {
  const Folder folder;
  const fs::path scene = folder.put("bad.nff", "b 0 0 0\ns 0 0 nan 1\n");
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", folder / "a.png"}), 1, scene.string() + ":2: "));
  EXPECT_TRUE(fails_with(kdray({"render", folder / "none.nff", "-o", folder / "a.png"}), 1, "none.nff"));
  EXPECT_TRUE(
      fails_with(kdray({"render", folder.path(), "-o", folder / "a.png"}), 1, folder.path().string()));
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(RenderCommand, AFailedRunKeepsTheOldPicture) {
  const Folder folder;
  folder.put("a.png", "the old picture");
  const fs::path scene = folder.put("bad.nff", "s 0 0\n");
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", folder / "a.png"}), 1, "bad.nff:1"));
  EXPECT_EQ(folder.get("a.png"), "the old picture");
}

TEST(RenderCommand, APictureTooLargeForTheMemoryIsExitCode4WithWhatWouldFit) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer needs all of the address space";
#endif
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const Outcome run = kdray({"render", scene, "-o", folder / "a.png", "--size", "16384x8192"},
                            {.limit_address_space = std::size_t{2} << 30});
  EXPECT_TRUE(fails_with(run, 4, "would fit"));
  int width = 0, height = 0;
  const std::size_t at = run.err.find("--size ");
  ASSERT_NE(at, std::string::npos) << run.err;
  ASSERT_EQ(std::sscanf(run.err.c_str() + at, "--size %dx%d", &width, &height), 2) << run.err;
  EXPECT_NEAR(static_cast<double>(width) / height, 2, 0.01);
  EXPECT_GT(width, 1024);
  EXPECT_LT(width, 16384 * 3 / 4);  // 2 GiB hold less than a half of it
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(RenderCommand, ADeviceThatIsNotThereIsExitCode3) {
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", folder / "a.png", "--device", "no-such-device"}), 3,
                         "device"));
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", folder / "a.png"},
                               {.environment = {{"OCL_ICD_VENDORS", folder.path().string() + "/"}}}),
                         3, "device"));
  EXPECT_EQ(folder.n_entries(), 1u);
}

// The file has a camera that looks away, and a light.
TEST(RenderCommand, AStudioThatIsAskedForStandsInForTheFilesOwnView) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const std::string objects = R"("objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}])";
  const fs::path bare = folder.put("bare.json", "{" + objects + "}");
  const fs::path lit = folder.put("lit.json",
                                  R"({"camera": {"from": [0, 0, 5], "at": [0, 0, 9]},
          "lights": [{"type": "point", "position": [0, 9, 0]}], )" +
                                      objects + "}");
  const auto rendered = [&](const fs::path& scene, std::vector<std::string> options) {
    std::vector<std::string> words = {"render", scene, "--size", "24", "-o", folder / "a.exr"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_TRUE(succeeds(kdray(words)));
    return folder.get("a.exr");
  };
  const std::string studio = rendered(bare, {});
  EXPECT_EQ(rendered(lit, {"--look", "studio"}), studio);
  EXPECT_EQ(rendered(lit, {"--look", "studio", "--from", "9,2,3"}), rendered(bare, {"--from", "9,2,3"}));
  EXPECT_EQ(rendered(lit, {"--look", "studio", "--up", "z"}), rendered(bare, {"--up", "z"}))
      << "as it looks along z";
  EXPECT_NE(rendered(lit, {}), studio);
  for (const char* const command : {"render", "view"})
    EXPECT_TRUE(fails_with(kdray({command, lit, "--look=studio", "--camera=9"}), 2, "no camera 9"))
        << command;
  EXPECT_EQ(rendered(bare, {"--size", "9", "--size", "24"}), studio) << "the last one counts";
}

}  // namespace
}  // namespace kdray::test
