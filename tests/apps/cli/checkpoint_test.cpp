// What    render --checkpoint and --resume: whatever ended a run, the next one's picture has the bytes of a
//         picture that was made in one go, and rays are traced only for what is missing.
#include <nlohmann/json.hpp>

#include <filesystem>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

struct CheckpointTest : testing::Test {
  Folder folder;
  fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  std::string picture = folder / "a.png", stats = folder / "a.json", checkpoint = folder / "checkpoint";

  Outcome render(const Arguments& more) const {
    Arguments arguments{"render", scene, "-o", picture, "--stats", stats};
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (std::find(more.begin(), more.end(), "--size") == more.end())
      arguments.insert(arguments.end(), {"--size", "200x150"});
    fs::remove(picture);
    return kdray(arguments);
  }
  Outcome go_on(Arguments more) const {
    more.insert(more.end(), {"--checkpoint", checkpoint, "--resume"});
    return render(more);
  }
  std::string reference(const Arguments& more) const {
    EXPECT_TRUE(succeeds(render(more)));
    return folder.get("a.png");
  }
  nlohmann::json told() const { return nlohmann::json::parse(folder.get("a.json"))["ledger"]; }

  fs::path tiles() const {
    for (const auto& entry : fs::directory_iterator(checkpoint))
      if (entry.path().extension() == ".tiles") return entry.path();
    return {};
  }
  // The run might have ended when it had written that share of the file.
  void cut(double share) const {
    fs::resize_file(tiles(),
                    static_cast<std::uintmax_t>(share * static_cast<double>(fs::file_size(tiles()))));
  }
};

TEST_F(CheckpointTest, AnyModeGoesOnFromWhatAnyModeLeft) {
  KDRAY_NEED_DEVICE();
  const std::vector<Arguments> modes = {{},
                                        {"--queues", "2"},
                                        {"--queues", "2", "--division", "interleaved"},
                                        {"--mode", "odprt", "--queues", "2"}};
  for (const char* const samples : {"4", "adaptive:0.01"}) {
    const std::string whole = reference({"--samples", samples});
    for (std::size_t i = 0; i < modes.size(); ++i) {
      SCOPED_TRACE(samples + std::string(" ") + std::to_string(i));
      fs::remove_all(checkpoint);
      Arguments first = modes[i], second = modes[(i + 1) % modes.size()];
      for (Arguments* const a : {&first, &second})
        a->insert(a->end(), {"--samples", samples, "--checkpoint-every", "0.01"});
      ASSERT_TRUE(succeeds(go_on(first)));
      EXPECT_EQ(folder.get("a.png"), whole);
      EXPECT_EQ(told()["found"], 0);
      cut(0.4);
      ASSERT_TRUE(succeeds(go_on(second)));
      EXPECT_EQ(folder.get("a.png"), whole);
      EXPECT_GT(told()["found"], 0);
      EXPECT_GT(told()["rendered"], 0);
      ASSERT_TRUE(succeeds(go_on(second)));
      EXPECT_EQ(folder.get("a.png"), whole);
      EXPECT_EQ(told()["rendered"], 0);
      EXPECT_EQ(nlohmann::json::parse(folder.get("a.json"))["rays"]["total"], 0);
    }
  }
}

TEST_F(CheckpointTest, WhatChangesOnlyTimesIsNoOtherRun) {
  KDRAY_NEED_DEVICE();
  const std::string whole = reference({});
  ASSERT_TRUE(succeeds(go_on({})));
  for (const Arguments& more : {Arguments{"--build", "best"},
                                {"--traversal", "wide"},
                                {"--schedule", "global"},
                                {"--tree-depth", "3"},
                                {"--device-memory", "100M"}}) {
    ASSERT_TRUE(succeeds(go_on(more)));
    EXPECT_EQ(told()["rendered"], 0) << more[0];
    EXPECT_EQ(folder.get("a.png"), whole);
  }
}

TEST_F(CheckpointTest, ThePictureAndItsFolderHaveDifferentNames) {
  for (const std::string option : {"--checkpoint", "--share"})
    EXPECT_TRUE(fails_with(render({"-o", folder / "x.png", option, folder / "x.png"}), 2,
                           "--output and " + option + " are the same"));
  EXPECT_FALSE(fs::exists(folder / "x.png"));
}

TEST_F(CheckpointTest, AnotherSceneOrOtherSettingsAreRefused) {
  KDRAY_NEED_DEVICE();
  ASSERT_TRUE(succeeds(go_on({})));
  EXPECT_TRUE(fails_with(render({"--checkpoint", checkpoint}), 2, "--resume"));
  EXPECT_TRUE(fails_with(go_on({"--size", "200x151"}), 1, "other settings (--size 200x150"));
  EXPECT_TRUE(fails_with(go_on({"--samples", "2"}), 1, "--samples 2"));
  EXPECT_TRUE(fails_with(go_on({"--samples", "adaptive"}), 1, "--samples adaptive"));
  EXPECT_TRUE(fails_with(go_on({"--depth", "2"}), 1, "--depth 2"));
  EXPECT_TRUE(fails_with(go_on({"--from", "1,2,9"}), 1, "another view"));
  EXPECT_TRUE(fails_with(go_on({"--crop", "100x70+3+4"}), 1, "--size 200x150 --crop 100x70+3+4 "));
  EXPECT_TRUE(fails_with(go_on({"--background", "1,0,0"}), 1, "another view or other settings"));
  EXPECT_TRUE(fails_with(go_on({"--tile", "16x8"}), 2, "leave --tile out"));
  folder.put("ball.nff", std::string(kSphereOnSquare) + "s 0 0 1 0.1\n");
  EXPECT_TRUE(fails_with(go_on({}), 1, "another scene"));
}

TEST_F(CheckpointTest, DamageIsToldOfAndTracedAgain) {
  KDRAY_NEED_DEVICE();
  const std::string whole = reference({});
  ASSERT_TRUE(succeeds(go_on({})));
  const fs::path file = tiles();
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(5000);
  stream << "damage";
  stream.close();
  const Outcome run = go_on({});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("1 damaged place in the checkpoint"), std::string::npos) << run.err;
  EXPECT_EQ(folder.get("a.png"), whole);
  EXPECT_EQ(told()["rendered"], 1);
}

TEST_F(CheckpointTest, OptionsThatDoNotGoTogether) {
  EXPECT_TRUE(fails_with(render({"--resume"}), 2, "--checkpoint DIR"));
  EXPECT_TRUE(fails_with(render({"--checkpoint-every", "3"}), 2, "--checkpoint DIR"));
  EXPECT_TRUE(fails_with(render({"--checkpoint", ""}), 2, "a folder"));
  EXPECT_TRUE(fails_with(render({"--checkpoint", "x", "--checkpoint-every", "0"}), 2, "--checkpoint-every"));
}

TEST_F(CheckpointTest, AFolderThatCannotBeMade) {
  KDRAY_NEED_DEVICE();
  EXPECT_TRUE(fails_with(render({"--checkpoint", folder.put("file", "")}), 1, "can't be made"));
}

}  // namespace
}  // namespace kdray::test
