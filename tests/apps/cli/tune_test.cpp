// What    kdray tune through the real program: what it keeps is used by render and told by --stats; wrong
//         candidates are left out; files that are no tunings cost a warning, not the picture.
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

std::vector<std::string> words(std::vector<std::string> first, const std::vector<std::string>& more) {
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

// The budget is so small that only what needs no compiler is worth its race.
Outcome tune(const Folder& folder, const std::vector<std::string>& more) {
  return kdray(words({"tune", folder / "balls.nff", "--size", "64x64", "--budget", "3"}, more),
               {.environment = {{"KDRAY_TUNE_FILE", folder / "tune.json"}}});
}

Outcome render(const Folder& folder, const std::vector<std::string>& more) {
  return kdray(words({"render", folder / "balls.nff", "--size", "64x64", "-o", folder / "a.png", "--no-cache",
                      "--stats", folder / "stats.json"},
                     more),
               {.environment = {{"KDRAY_TUNE_FILE", folder / "tune.json"}}});
}

Json stats(const Folder& folder) {
  return Json::parse(folder.get("stats.json"));
}

void make_scene(const Folder& folder) {
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "1", "-o", folder / "balls.nff"})));
}

TEST(Tune, KeepsAnEntryThatRenderUsesUnlessToldNotTo) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  make_scene(folder);
  ASSERT_TRUE(succeeds(render(folder, {})));
  const std::string picture = folder.get("a.png");
  EXPECT_EQ(stats(folder)["device"]["tuning"]["from"], "shipped");
  ASSERT_TRUE(succeeds(tune(folder, {"--stats", folder / "search.json", "--explain"})));
  Json tunings = Json::parse(folder.get("tune.json"));
  ASSERT_EQ(tunings["entries"].size(), 1u);
  EXPECT_GT(Json::parse(folder.get("search.json"))["tuned"][0]["races"].size(), 0u);

  // Whatever was found on a busy machine: these are surely used, and change no bit.
  tunings["entries"][0]["settings"] = {{"batch", 256}, {"tile", 16},     {"slices", 4},
                                       {"waves", 16},  {"packets", 4},   {"batch-rays", 16},
                                       {"spread", 18}, {"distance", 60}, {"prefetch", 2}};
  std::ofstream(folder / "tune.json") << tunings;
  ASSERT_TRUE(succeeds(render(folder, {})));
  EXPECT_EQ(stats(folder)["device"]["tuning"]["settings"], tunings["entries"][0]["settings"]);
  EXPECT_NE(stats(folder)["device"]["tuning"]["from"], "shipped");
  EXPECT_EQ(folder.get("a.png"), picture);
  ASSERT_TRUE(succeeds(render(folder, {"--no-tuning"})));
  EXPECT_EQ(stats(folder)["device"]["tuning"]["from"], "shipped");
  EXPECT_EQ(folder.get("a.png"), picture);
}

TEST(Tune, ACandidateWithAWrongPictureIsNotTimed) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  make_scene(folder);
  ASSERT_TRUE(succeeds(tune(folder, {"--stats", folder / "search.json", "--t4", folder / "t4.json",
                                     "--inject-fault", "batch=256"})));
  const Json search = Json::parse(folder.get("search.json"));
  int seen = 0;
  for (const Json& race : search["tuned"][0]["races"])
    for (const Json& rival : race["rivals"])
      if (race["setting"] == "batch" && rival["value"] == 256) {
        ++seen;
        EXPECT_EQ(rival["verdict"], "wrong");
        EXPECT_EQ(rival["rounds"], 0);
      }
  EXPECT_GE(seen, 1);

  // The same in T4: schema/T4/1.0.0/results-schema.json of Kernel Tuner.
  const Json t4 = Json::parse(folder.get("t4.json"));
  EXPECT_EQ(t4["schema_version"], "1.0.0");
  std::size_t wrong = 0;
  for (const Json& result : t4["results"]) {
    EXPECT_EQ(result["configuration"].size(), 10u) << "every setting";
    EXPECT_EQ(result["objectives"], Json::array({"time"}));
    const bool is_wrong = result["configuration"]["batch"] == 256;
    EXPECT_EQ(result["correctness"], is_wrong ? 0 : 1);
    if (is_wrong) {
      ++wrong;
      EXPECT_EQ(result["invalidity"], "correctness");
      EXPECT_TRUE(result["times"]["runtimes"].empty());
    } else if (result["invalidity"] == "correct") {
      EXPECT_GT(result["times"]["runtimes"].at(0), 0.0);
      EXPECT_EQ(result["measurements"].at(0)["name"], "time");
    } else {
      EXPECT_EQ(result["invalidity"], "timeout");
    }
  }
  EXPECT_GE(wrong, 1u);
  EXPECT_NE(Json::parse(folder.get("tune.json"))["entries"][0]["settings"].value("batch", 0), 256);
}

TEST(Tune, AFileThatIsNoneCostsAWarning) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  make_scene(folder);
  folder.put("tune.json", "{\"kdray_tunings\": 1, \"entr");
  const Outcome run = render(folder, {});
  ASSERT_TRUE(succeeds(run));
  const std::string warning = "tune.json: not a file of tunings; it is ignored";
  ASSERT_NE(run.err.find(warning), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find(warning), run.err.rfind(warning)) << "said once";
  EXPECT_EQ(stats(folder)["device"]["tuning"]["from"], "shipped");
}

TEST(Tune, MergesFilesAndRefusesWhatIsNone) {
  const Folder folder;
  const std::string entry =
      R"({"device":"d","driver":"v","kernels":"k","schedule":"slices","features":"any",)"
      R"("settings":{"batch":256},)"
      R"("ratio":0.9,"seconds":1,"when":1,"scenes":[]})";
  folder.put("a.json", R"({"kdray_tunings":1,"entries":[)" + entry + "]}");
  folder.put("bad.json", "nonsense");
  ASSERT_TRUE(succeeds(kdray({"tune", "--merge", folder / "a.json", "-o", folder / "all.json"})));
  EXPECT_EQ(Json::parse(folder.get("all.json"))["entries"][0]["settings"]["batch"], 256);
  EXPECT_TRUE(
      fails_with(kdray({"tune", "--merge", folder / "bad.json", "-o", folder / "all.json"}), 1, "bad.json"));
  EXPECT_TRUE(fails_with(kdray({"tune", "--merge", folder / "none.json", "-o", folder / "all.json"}), 1,
                         "none.json"));
  EXPECT_TRUE(fails_with(kdray({"tune", "no-such-scene", "-o", folder / "all.json"}), 1, "no-such-scene"));
}

}  // namespace
}  // namespace kdray::test
