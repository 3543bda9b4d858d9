// Sequences and shared pictures: each frame has the bytes of the picture that the same camera or scene gives
// by itself, whoever made it.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/camera_path.h"
#include "apps/cli/program.h"
#include "apps/cli/running.h"
#include "apps/cli/scenes.h"
#include "apps/cli/sequence.h"
#include "engine/checkpoint/header.h"
#include "engine/checkpoint/record.h"
#include "io/image/picture_file.h"
#include "support/errors.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr const char* kPath =
    R"({"kdray_camera_path": 1, "interpolation": "linear", "keys": [
  {"frame": 2, "from": [0, -6, 3], "at": [0, 0, 1], "up": [0, 0, 1], "fov": 40},
  {"frame": 4, "from": [2, -6, 5], "at": [0, 0, 0], "up": [0, 0, 1], "fov": 30}]})";

struct SequenceTest : testing::Test {
  Folder folder;
  fs::path scene = folder.put("ball.nff", kSphereOnSquare), path = folder.put("path.json", kPath);

  Outcome render(const Arguments& more) const {
    Arguments arguments{"render", scene, "--size", "120x80", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return kdray(arguments, {.folder = folder.path()});
  }
  std::string seen(const std::string& from, const std::string& at, const std::string& fov) const {
    EXPECT_TRUE(
        succeeds(render({"-o", folder / "one.png", "--from", from, "--at", at, "--up", "z", "--fov", fov})));
    return folder.get("one.png");
  }
};

TEST_F(SequenceTest, FramesAreWhatTheirCamerasSee) {
  KDRAY_NEED_DEVICE();
  ASSERT_TRUE(succeeds(render({"-o", folder / "f.png", "--frames", "0..5", "--camera-path", path})));
  EXPECT_EQ(folder.get("f0000.png"), seen("0,-6,3", "0,0,1", "40"));
  EXPECT_EQ(folder.get("f0002.png"), folder.get("f0000.png"));
  EXPECT_EQ(folder.get("f0003.png"), seen("1,-6,4", "0,0,0.5", "35"));
  EXPECT_EQ(folder.get("f0004.png"), seen("2,-6,5", "0,0,0", "30"));
  EXPECT_EQ(folder.get("f0005.png"), folder.get("f0004.png"));
}

TEST_F(SequenceTest, ATurntableGoesOnceAroundTheModel) {
  KDRAY_NEED_DEVICE();
  const Arguments view{"--at", "0,0,1", "--up", "z", "--fov", "40"};
  Arguments turn{"-o", folder / "t%d.exr", "--turntable", "4", "--from", "0,-6,3"};
  turn.insert(turn.end(), view.begin(), view.end());
  ASSERT_TRUE(succeeds(render(turn)));
  const char* const cameras[] = {"0,-6,3", "6,0,3", "0,6,3", "-6,0,3"};
  for (int frame = 0; frame < 4; ++frame) {
    Arguments one{"-o", folder / "one.exr", "--from", cameras[frame]};
    one.insert(one.end(), view.begin(), view.end());
    ASSERT_TRUE(succeeds(render(one)));
    const std::string name = folder / fmt::format("t{}.exr", frame);
    // A pixel on an edge may be another one, since the camera's place is rounded.
    EXPECT_TRUE(succeeds(kdray({"compare", name, folder / "one.exr", "--max-rmse", "0.01"}))) << frame;
  }
  EXPECT_FALSE(fs::exists(folder / "t4.exr"));
  EXPECT_EQ(kdray({"compare", folder / "t0.exr", folder / "t1.exr", "--max-rmse", "0.01"}).code, 1)
      << "all are the same";
}

// A long box, seen from a place that is chosen: its ends are in every frame, and so is some background
// around.
TEST_F(SequenceTest, ATurntableShowsAllOfTheModelInEachFrame) {
  KDRAY_NEED_DEVICE();
  folder.put("bar.json", R"({"objects": [{"type": "box", "min": [-9, 0, -1], "max": [9, 1, 1]}]})");
  ASSERT_TRUE(succeeds(kdray({"render", "bar.json", "--turntable", "8", "--size", "64x64", "-q",
                              "--background", "transparent", "-o", "b.exr"},
                             {.folder = folder.path()})));
  int widest = 0;
  for (int frame = 0; frame < 8; ++frame) {
    const image::Image seen = image::read_picture(folder / fmt::format("b{:04}.exr", frame), {});
    float most = 0, at_edge = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const float alpha = seen.alpha[static_cast<std::size_t>(y * 64 + x)];
        most = std::max(most, alpha);
        if (alpha > 0) widest = std::max(widest, std::abs(x - 32));
        if (x % 63 == 0 || y % 63 == 0) at_edge = std::max(at_edge, alpha);
      }
    EXPECT_EQ(most, 1) << frame;
    EXPECT_EQ(at_edge, 0) << frame << ": it reaches out of the picture";
  }
  EXPECT_GE(widest, 26) << "it is framed as closely as that allows";
}

// Walls, floor and ceiling that face inward hide what is outside; each frame sees another wall.
TEST_F(SequenceTest, ATurntableInARoomLooksAround) {
  KDRAY_NEED_DEVICE();
  folder.put("room.obj",
             "v -4 0 -4\nv 4 0 -4\nv 4 3 -4\nv -4 3 -4\nv -4 0 5\nv 4 0 5\nv 4 3 5\nv -4 3 5\n"
             "f 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1\nf 4 3 7 8\n");
  ASSERT_TRUE(succeeds(kdray({"render", "room.obj", "--turntable", "4", "--size", "24x24", "-q",
                              "--background", "transparent", "-o", "r.exr"},
                             {.folder = folder.path()})));
  for (int frame = 0; frame < 4; ++frame) {
    const std::string name = fmt::format("r{:04}.exr", frame);
    EXPECT_EQ(std::ranges::min(image::read_picture(folder / name, {}).alpha), 1) << frame;
    for (int other = 0; other < frame; ++other)
      EXPECT_NE(folder.get(fmt::format("r{:04}.exr", other)), folder.get(name)) << frame;
  }
}

TEST_F(SequenceTest, ATurntableOfASinglePointIsNoError) {
  KDRAY_NEED_DEVICE();
  folder.put("a.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n");
  EXPECT_TRUE(succeeds(
      kdray({"render", "a.obj", "--turntable", "2", "--size", "8", "-q"}, {.folder = folder.path()})));
}

TEST_F(SequenceTest, ATurntableStandsInTheStudio) {
  KDRAY_NEED_DEVICE();
  folder.put("a.obj", "v -1 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
  const auto turned = [&](const std::string& name, const Arguments& more) {
    Arguments arguments{"render", "a.obj", "--turntable", "2", "--size", "24", "-q", "-o", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_TRUE(succeeds(kdray(arguments, {.folder = folder.path()})));
    return folder.get(name.substr(0, 1) + "0001.png");
  };
  EXPECT_NE(turned("s.png", {}), turned("p.png", {"--look", "plain"}));
  EXPECT_EQ(turned("t.png", {"--look", "studio"}), folder.get("s0001.png"));
}

TEST_F(SequenceTest, ATurntableSaysHowToMakeAFilmOfIt) {
  KDRAY_NEED_DEVICE();
  const Outcome run = kdray({"render", "ball.nff", "--turntable", "9", "--frames", "4..5", "--size", "8x8"},
                            {.folder = folder.path()});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(fs::exists(folder / "ball0004.png") && fs::exists(folder / "ball0005.png"));
  EXPECT_FALSE(fs::exists(folder / "ball0003.png") || fs::exists(folder / "ball0006.png"));
  const Outcome odd = kdray({"render", "ball.nff", "--turntable", "2", "--size", "9x8", "-o", "100%s%d.png"},
                            {.folder = folder.path()});
  ASSERT_TRUE(succeeds(odd));
  EXPECT_TRUE(fs::exists(folder / "100%s1.png"));
  EXPECT_NE(odd.err.find("-i '100%%s%d.png' -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -pix_fmt"), std::string::npos)
      << odd.err;
  EXPECT_NE(
      run.err.find("ffmpeg -framerate 24 -start_number 4 -i 'ball%04d.png' -pix_fmt yuv420p 'ball.mp4'"),
      std::string::npos)
      << run.err;
}

TEST_F(SequenceTest, ATurntableGoesAlone) {
  EXPECT_TRUE(fails_with(render({"--turntable", "4", "--camera-path", path}), 2, "--camera-path"));
  EXPECT_TRUE(fails_with(render({"--turntable", "4", "--fps", "24"}), 2, "--fps"));
  EXPECT_TRUE(fails_with(render({"--turntable", "4", "--frames", "0..4"}), 2, "the frames 0 to 3"));
  EXPECT_TRUE(fails_with(render({"--turntable", "0"}), 2, "from 1"));
  EXPECT_TRUE(fails_with(kdray({"render", "s%02d.nff", "--turntable", "4"}), 2, "one model"));
  EXPECT_TRUE(fails_with(render({"--turntable", "4", "-o", "-"}), 2, "a file for each frame"));
}

TEST_F(SequenceTest, ACameraPathKeepsTheRestOfTheCamera) {
  KDRAY_NEED_DEVICE();
  const fs::path still =
      folder.put("still.json",
                 R"({"kdray_camera_path": 1, "keys": [{"frame": 0, "from": [0, 0, 5], "at": [0, 0, 0]}]})");
  const auto picture = [&](const std::string& scene, const Arguments& more) {
    Arguments arguments{"render", scene, "--size", "40x30", "-q", "-o", more.empty() ? "w.exr" : "p%d.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_TRUE(succeeds(kdray(arguments, {.folder = folder.path()})));
    return folder.get(more.empty() ? "w.exr" : "p0.exr");
  };
  const Arguments along = {"--camera-path", still.string(), "--frames", "0..0"};
  for (const std::string lens :
       {R"("ortho": 4, "hither": 4.5)", R"("aperture": 0.5, "focus": 3)", R"("hither": 4.5)"}) {
    const std::string name =
        folder
            .put("scene.json", R"({"camera": {"from": [0, 0, 5], "at": [0, 0, 0], )" + lens +
                                   R"(}, "objects": [
      {"type": "sphere", "center": [0, 0, 0], "radius": 1},
      {"type": "sphere", "center": [0.3, 0, 2], "radius": 0.5}]})")
            .string();
    EXPECT_EQ(picture(name, along), picture(name, {})) << lens;
  }
  folder.put("plain.json", R"({"camera": {"from": [0, 0, 5], "at": [0, 0, 0]},
                               "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
  Arguments focused = along;
  focused.insert(focused.end(), {"--aperture", "0.5", "--focus", "2"});
  EXPECT_NE(picture("plain.json", focused), picture("plain.json", along));
  const std::string keys = R"({"kdray_camera_path": 1, "keys": [
      {"frame": 0, "from": [0, 0, 5], "at": [0, 0, 0], "aperture": 0.5, "focus": 2},
      {"frame": 9, "from": [0, 0, 5], "at": [0, 0, 0], )";
  const Arguments pulled = {"--camera-path",
                            folder.put("f.json", keys + R"("aperture": 0.1, "focus": 3}]})").string(),
                            "--frames", "0..0"};
  EXPECT_EQ(picture("plain.json", pulled), picture("plain.json", focused));
  // A curve that begins level must not swing below 0.
  folder.put("o.json", R"({"kdray_camera_path": 1, "keys": [
      {"frame": 0, "from": [0, 0, 5], "at": [0, 0, 0], "aperture": 0},
      {"frame": 4, "from": [0, 0, 5], "at": [0, 0, 0], "aperture": 0},
      {"frame": 8, "from": [0, 0, 5], "at": [0, 0, 0], "aperture": 0.5}]})");
  EXPECT_TRUE(succeeds(kdray({"render", "plain.json", "--camera-path", "o.json", "--frames", "2..2", "--size",
                              "8x6", "-q", "-o", "o%d.png"},
                             {.folder = folder.path()})));
  folder.put("g.json", keys + R"("focus": 3}]})");
  EXPECT_TRUE(fails_with(render({"--camera-path", folder / "g.json", "--frames", "0..0"}), 1,
                         "g.json: /keys/1: 'aperture' is in some keys and not in others"));
}

TEST_F(SequenceTest, NumberedScenesAreFramesToo) {
  KDRAY_NEED_DEVICE();
  fs::copy_file(scene, folder / "s07.nff");
  folder.put("s08.nff", std::string(kSphereOnSquare) + "s 1 0 2 0.5\n");
  const Outcome run =
      kdray({"render", "s%02d.nff", "--frames", "7..8", "--size", "120x80", "-q", "--stats", "s.json"},
            {.folder = folder.path()});
  ASSERT_TRUE(succeeds(run));
  for (const char* const name : {"s07", "s08"}) {
    ASSERT_TRUE(
        succeeds(kdray({"render", std::string(name) + ".nff", "--size", "120x80", "-q", "-o", "one.png"},
                       {.folder = folder.path()})));
    EXPECT_EQ(folder.get(std::string(name) + ".png"), folder.get("one.png"));
  }
  EXPECT_TRUE(fs::exists(folder / "s0007.json"));
  EXPECT_TRUE(fails_with(kdray({"render", "s%02d.nff", "--frames", "9..9", "-q"}, {.folder = folder.path()}),
                         1, "s09.nff: no such file"));
}

// A pyramid that stands on z, which is found out by its base, and flies up and to the right.
std::string flying(int frame) {
  const double by = 0.15 * frame;
  std::string text;
  for (const auto& [x, y, z] : {std::array{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 1}})
    text += fmt::format("v {} {} {}\n", x + by, y, z + by);
  return text + "f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
}

// What moves does so in the film: a view that is made up is that of the first frame.
TEST_F(SequenceTest, NumberedScenesHaveOneViewThatIsMadeUp) {
  KDRAY_NEED_DEVICE();
  const auto own_view = [](int frame) {
    return fmt::format(R"({{"camera": {{"from": [0, -5, 0], "at": [{0}, 0, 0], "up": [0, 0, 1]}},
        "lights": [{{"type": "point", "position": [0, -9, 9]}}],
        "objects": [{{"type": "sphere", "center": [{0}, 0, {0}], "radius": 1}}]}})",
                       0.15 * frame);
  };
  for (int i = 0; i < 3; ++i) {
    folder.put(fmt::format("w{}.obj", i), flying(i));
    folder.put(fmt::format("j{}.json", i), own_view(i));
  }
  struct Seen {
    double column = 0, row = 0, n = 0;
  };
  const auto seen = [&](int frame) {
    const image::Image depth = image::read_picture(folder / fmt::format("f{}.depth.png", frame), {});
    Seen sum;
    for (std::size_t i = 0; i < depth.pixels.size(); ++i)
      if (depth.pixels[i].x > 0)
        sum.column += static_cast<double>(i % 96), sum.row += static_cast<double>(i / 96), ++sum.n;
    return Seen{sum.column / sum.n, sum.row / sum.n, sum.n};
  };
  const auto film = [&](const std::string& scenes, Arguments more) {
    Arguments arguments{"render", scenes, "--frames",  "0..2", "--size", "96x72",  "--aov",
                        "depth",  "-q",   "--samples", "1",    "-o",     "f%d.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_TRUE(succeeds(kdray(arguments, {.folder = folder.path()})));
  };
  const std::vector<std::pair<std::string, Arguments>> films = {
      {"w%d.obj", {}},
      {"w%d.obj", {"--look", "plain", "--up", "z"}},
      {"w%d.obj", {"--view", "front", "--up", "z"}},
      {"j%d.json", {"--look", "studio", "--up", "z"}},
      {"j%d.json", {"--view", "front"}}};
  for (const auto& [scenes, more] : films) {
    SCOPED_TRACE(fmt::format("{} {}", scenes, fmt::join(more, " ")));
    film(scenes, more);
    for (int frame = 1; frame < 3; ++frame) {
      const Seen before = seen(frame - 1), now = seen(frame);
      EXPECT_GT(now.column, before.column + 1) << frame;
      EXPECT_TRUE(scenes != "w%d.obj" || now.row < before.row - 1) << frame;
      EXPECT_NEAR(now.n / before.n, 1, 0.25) << frame;
    }
  }
  // What comes before anything is there has a view of its own; a camera of its own, lights for that.
  folder.put("w0.obj", "v 0 0 0\n");
  film("w%d.obj", {});
  EXPECT_GT(seen(1).n, 1000) << "the first that shows anything is framed";
  EXPECT_GT(seen(2).column, seen(1).column + 1);
  folder.put("w0.obj", flying(0));
  const auto unlit = [](double x, double z) {
    return fmt::format(R"({{"camera": {{"from": [{}, 0, {}], "at": [0, 0, 0], "up": [0, 1, 0]}},
        "objects": [{{"type": "sphere", "center": [0, 0, 0], "radius": 1}}]}})",
                       x, z);
  };
  folder.put("h0.json", unlit(0, 5)), folder.put("h1.json", unlit(5, 0));
  const Arguments lit = {"--size", "64x48", "-q", "--look", "plain", "--headlight", "1"};
  Arguments both{"render", "h%d.json", "--frames", "0..1", "-o", "g%d.png"},
      alone{"render", "h1.json", "-o", "h.png"};
  both.insert(both.end(), lit.begin(), lit.end()), alone.insert(alone.end(), lit.begin(), lit.end());
  ASSERT_TRUE(succeeds(kdray(both, {.folder = folder.path()})));
  ASSERT_TRUE(succeeds(kdray(alone, {.folder = folder.path()})));
  EXPECT_EQ(folder.get("g1.png"), folder.get("h.png"));
  // Whoever makes a frame finds out about the first one.
  film("w%d.obj", {"--share", "shared"});
  const std::string last = folder.get("f2.png");
  fs::remove(folder / "f2.png");
  film("w%d.obj", {"--share", "shared"});
  EXPECT_EQ(folder.get("f2.png"), last);
  film("w%d.obj", {});
  EXPECT_EQ(folder.get("f2.png"), last);
  EXPECT_TRUE(fails_with(kdray({"render", "w%d.obj", "--frames", "1..2", "--size", "96x72", "--aov", "depth",
                                "-q", "--samples", "1", "--share", "shared", "-o", "f%d.png"},
                               {.folder = folder.path()}),
                         1, "--frames from"));
}

TEST_F(SequenceTest, ProcessesThatShareAFolderMakeAllFrames) {
  KDRAY_NEED_DEVICE();
  const Arguments frames{"--frames", "1..5", "--camera-path", path};
  Arguments alone{"-o", folder / "a%d.png"};
  alone.insert(alone.end(), frames.begin(), frames.end());
  ASSERT_TRUE(succeeds(render(alone)));
  Arguments shared{
      "render", scene, "--size", "120x80", "-o", folder / "b%d.png", "--share", folder / "checkpoint"};
  shared.insert(shared.end(), frames.begin(), frames.end());
  std::vector<Running> runs;
  for (int i = 0; i < 3; ++i) runs.emplace_back(shared, folder / "log");
  for (Running& run : runs) {
    ASSERT_TRUE(run.wait());
    EXPECT_EQ(run.code(), 0) << folder.get("log");
  }
  for (int i = 1; i <= 5; ++i)
    EXPECT_EQ(folder.get(fmt::format("b{}.png", i)), folder.get(fmt::format("a{}.png", i))) << i;
  shared.insert(shared.end(), {"--samples", "2"});
  EXPECT_TRUE(fails_with(kdray(shared), 1, "other settings"));
  // Frames that are done would be left as they are, and others made otherwise.
  shared.back() = "3";
  std::ranges::replace(shared, "1..5", "1..6");
  EXPECT_TRUE(fails_with(kdray(shared), 1, "--samples 0; here --samples 3"));
  EXPECT_FALSE(fs::exists(folder / "b6.png"));
}

// The same records twice are no fault; one whose sums differ is, however right its checksums are.
TEST_F(SequenceTest, AMachineThatComputesWronglyIsToldOf) {
  KDRAY_NEED_DEVICE();
  const Arguments share{"-o", folder / "a.png", "--share", folder / "checkpoint"};
  ASSERT_TRUE(succeeds(render(share)));
  for (const auto& entry : fs::directory_iterator(folder / "checkpoint"))
    if (entry.path().extension() == ".tiles") fs::copy_file(entry.path(), folder / "checkpoint/copy.tiles");
  EXPECT_TRUE(succeeds(render(share)));
  const std::string good = folder.get("checkpoint/copy.tiles");
  std::string wrong = good.substr(0, checkpoint::kHeaderBytes);
  const Hash frame = checkpoint::header_of(good)->frame();
  const auto head = checkpoint::head_of(std::string_view(good).substr(checkpoint::kHeaderBytes), frame);
  ASSERT_TRUE(head);
  std::vector<layout::i64> sums(head->id.places.sums());
  std::memcpy(sums.data(), good.data() + checkpoint::kHeaderBytes + checkpoint::kRecordHead, sums.size() * 8);
  ++sums.back();  // by 2^-36
  checkpoint::append_record(wrong, frame, head->id, sums, checkpoint::hash_of_sums(sums));
  folder.put("checkpoint/wrong.tiles", wrong);
  EXPECT_TRUE(fails_with(render(share), 1, "was made twice, and the results differ: by "));
}

TEST_F(SequenceTest, RestartsEndWithTheRunsOwnCode) {
  KDRAY_NEED_DEVICE();
  EXPECT_TRUE(
      succeeds(render({"-o", folder / "a.png", "--checkpoint", folder / "checkpoint", "--restarts", "3"})));
  EXPECT_TRUE(fails_with(render({"--checkpoint", folder / "checkpoint", "--restarts=3"}), 2, "--resume"));
  EXPECT_TRUE(succeeds(render({"--checkpoint", folder / "checkpoint", "--restarts=3", "--resume"})));
}

TEST_F(SequenceTest, WhatMakesNoSequence) {
  EXPECT_TRUE(fails_with(render({"--frames", "1..2"}), 2,
                         "--camera-path FILE or --turntable N, or number the scenes"));
  EXPECT_TRUE(fails_with(render({"--camera-path", path}), 2, "--frames A..B"));
  EXPECT_TRUE(fails_with(render({"--frames", "1-2", "--camera-path", path}), 2, "A..B"));
  EXPECT_TRUE(fails_with(render({"--frames", "3..2", "--camera-path", path}), 2, "--frames"));
  EXPECT_TRUE(fails_with(render({"--frames", "1..2", "--camera-path", path, "--fov", "3"}), 2, "--fov"));
  EXPECT_TRUE(
      fails_with(render({"--frames", "1..2", "--camera-path", path, "--camera", "0"}), 2, "--camera"));
  EXPECT_TRUE(
      fails_with(render({"--frames", "1..2", "--camera-path", path, "-o", "-"}), 2, "a file for each frame"));
  EXPECT_TRUE(fails_with(render({"--restarts", "2"}), 2, "--checkpoint DIR or --share DIR"));
  EXPECT_TRUE(fails_with(render({"--lease", "2"}), 2, "--share DIR"));
  EXPECT_TRUE(fails_with(render({"--share", "a", "--checkpoint", "b"}), 2, "give one of them"));
  EXPECT_TRUE(fails_with(render({"--share", "a", "--resume"}), 2, "leave --resume out"));
  EXPECT_TRUE(fails_with(render({"--frames", "1..2", "--camera-path", "none.json"}), 1, "none.json"));
  const fs::path through = folder.put("through.json", R"({"kdray_camera_path": 1,
    "interpolation": "linear", "keys": [{"frame": 0, "from": [0, 0, 1], "at": [0, 0, 0]},
                                        {"frame": 4, "from": [0, 0, -1], "at": [0, 0, 0]}]})");
  EXPECT_TRUE(
      fails_with(render({"--frames", "0..4", "--camera-path", through, "-o", "t%d.png"}), 1, "at frame 2"));
  EXPECT_FALSE(fs::exists(folder / "t0.png")) << "it is refused before anything is rendered";
  EXPECT_TRUE(fails_with(render({"--frames", "0..1", "--camera-path", folder.put("a.json", "{}")}), 1,
                         "a.json: is no camera path"));
}

TEST(CameraPath, SmoothCurvesPassTheKeysAndReproduceParabolas) {
  const Folder folder;
  std::string keys;
  const auto parabola = [](double t) { return 0.25 * t * t - 3 * t + 1; };
  for (const int t : {0, 3, 4, 9})
    keys += fmt::format(R"({}{{"frame": {}, "from": [{}, 0, 9], "at": [0, {}, 0]}})",
                        keys.empty() ? "" : ", ", t, parabola(t), 2 * t);
  const cli::CameraPath path(folder.put("p.json", R"({"kdray_camera_path": 1, "keys": [)" + keys + "]}"));
  for (const int t : {0, 3, 4, 9}) EXPECT_NEAR(path.at(t).from[0], parabola(t), 1e-12) << t;
  EXPECT_NEAR(path.at(5).at[1], 10, 1e-12);  // a line stays one
  EXPECT_EQ(path.at(100).from, path.at(9).from);
  EXPECT_EQ(path.at(7).up, (Vec3{0, 1, 0}));
  EXPECT_EQ(path.at(7).fov, 45);
}

TEST(CameraPath, WhatIsWrongIsTold) {
  const Folder folder;
  const auto refuses = [&](const std::string& keys, const std::string& text) {
    const fs::path file = folder.put("p.json", R"({"kdray_camera_path": 1, "keys": [)" + keys + "]}");
    return fails(
        [&] {
          const cli::CameraPath path(file);
          for (int frame = 0; frame < 20; ++frame) (void)path.at(frame);
        },
        text, ErrorCode::input);
  };
  EXPECT_TRUE(refuses("", "one key at least"));
  EXPECT_TRUE(refuses(R"({"frame": 0, "from": [0, 0, 1]})", "p.json: /keys/0"));
  EXPECT_TRUE(refuses(R"({"frame": 0, "from": [0, 0, 1], "at": [0, 0, 1]})", "same point"));
  EXPECT_TRUE(refuses(R"({"frame": 0, "from": [0, 0, 1], "at": [0, 0, 0], "fov": 200})", "/keys/0/fov"));
  EXPECT_TRUE(refuses(R"({"frame": 0, "from": [0, 0, 1], "at": [0, 0, 0], "roll": 2})", "roll"));
  EXPECT_TRUE(refuses(
      R"({"frame": 3, "from": [0, 0, 1], "at": [0, 0, 0]}, {"frame": 3, "from": [0, 0, 2], "at": [0, 0, 0]})",
      "not behind"));
  EXPECT_TRUE(refuses(R"({"frame": 0, "from": [0, 0, 1], "at": [0, 0, 0]}, )"
                      R"({"frame": 10, "from": [0, 0, -1], "at": [0, 0, 0]})",
                      "at frame 5"));
}

TEST(Numbered, NamesOfFrames) {
  EXPECT_EQ(cli::numbered("a/out.png", 7, true), "a/out0007.png");
  EXPECT_EQ(cli::numbered("a/out.png", 7, false), "a/out.png");
  EXPECT_EQ(cli::numbered("a/%d.png", 7, true), "a/7.png");
  EXPECT_EQ(cli::numbered("%d/out%03d.png", 12345, true), "%d/out12345.png");
  EXPECT_EQ(cli::numbered("100%.png", 7, true), "100%0007.png");
  EXPECT_EQ(cli::numbered("100%_%06d.exr", 7, true), "100%_000007.exr");
}

}  // namespace
}  // namespace kdray::test
