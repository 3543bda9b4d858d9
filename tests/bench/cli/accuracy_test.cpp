// What    kdray bench accuracy as a user runs it, on tiny scenes: exit codes, the report, and what must hold
//         of any errors. No time is asserted.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "bench/cli/expect_keys.h"
#include "kdray/kdray.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

Json run_on(const Folder& folder, const std::string& scene, const std::vector<std::string>& more) {
  std::vector<std::string> words = {"bench",
                                    "accuracy",
                                    folder.put("small.nff", scene).string(),
                                    "--size",
                                    "32x32",
                                    "--repeat",
                                    "1",
                                    "--reference-samples",
                                    "64",
                                    "--report",
                                    (folder / "report").string()};
  words.insert(words.end(), more.begin(), more.end());
  const Outcome run = kdray(words);
  EXPECT_TRUE(succeeds(run));
  expect_plot(run, folder, "report/accuracy.svg", ">small<");
  return Json::parse(folder.get("report/accuracy.json"));
}

// A red-hot ball above a mirror, between two more mirrors: every depth shows something new.
constexpr const char* kMirrors =
    "v\nfrom 0 -6 3\nat 0 0 1\nup 0 0 1\nangle 40\nhither 0.1\nresolution 32 32\n"
    "b 0.1 0.2 0.4\n"
    "l -4 -5 8\n"
    "f 0.8 0.8 0.8 0.2 0.7 10 0 0\n"
    "p 4\n-4 -4 0\n4 -4 0\n4 4 0\n-4 4 0\n"
    "p 4\n-1.5 -4 0\n-1.5 4 0\n-1.5 4 4\n-1.5 -4 4\n"
    "p 4\n1.5 -4 0\n1.5 4 0\n1.5 4 4\n1.5 -4 4\n"
    "f 0.9 0.3 0.2 0.7 0.2 40 0 0\n"
    "s 0 0 1 0.7\n";

TEST(BenchAccuracy, ErrorsAreThoseThatTheSettingsPromise) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Json json = run_on(folder, kMirrors, {"--no-povray"});
  expect_keys(json, {"command", "size", "repeat", "reference_samples", "unlike_base", "runs"});
  EXPECT_EQ(json["unlike_base"], 0);
  const Json& run = json["runs"][0];
  expect_keys(run, {"scene", "device", "primitives", "cores", "reference", "points", "povray", "adaptive"});
  expect_keys(run["reference"], {"seconds", "own_error", "precision", "picture"});
  EXPECT_TRUE(run["povray"].is_null());
  std::map<std::string, Json> named;
  for (const Json& p : run["points"]) {
    expect_keys(p, {"group", "name", "seconds", "error", "on_front", "picture", "change", "samples", "depth",
                    "min_weight", "light_reach", "traversal", "build", "precision", "adaptive_target",
                    "believed_rmse"});
    for (const auto& [key, value] : p["error"].items())
      EXPECT_TRUE(std::isfinite(value.get<double>())) << key;
    EXPECT_GT(folder.get("report/accuracy/" + p["picture"].get<std::string>()).size(), 0u) << p["picture"];
    named[p["name"]] = p;
  }
  EXPECT_EQ(run["points"][0]["change"], 0);
  const auto error = [&](const char* name) { return named.at(name)["error"]["rmse"].get<double>(); };
  const auto change = [&](const char* name) { return named.at(name)["change"].get<double>(); };
  // Mirrors between mirrors: each depth that is left out costs more than the next.
  EXPECT_GT(change("depth 1"), change("depth 2"));
  EXPECT_GT(change("depth 2"), change("depth 3"));
  EXPECT_GT(change("depth 3"), change("depth 8"));
  EXPECT_GT(change("depth 8"), 0);
  EXPECT_GT(error("depth 1"), error("16 samples, depth 16 (base)"));
  EXPECT_GE(change("weight 0.1"), change("weight 0.02"));
  EXPECT_GE(change("weight 0.02"), change("weight 0.004"));
  EXPECT_GT(change("weight 0.1"), 0);
  EXPECT_LT(error("adaptive:0.005, depth 16"), error("adaptive:0.02, depth 16"));
  EXPECT_GT(named.at("adaptive:0.005, depth 16")["samples"], named.at("adaptive:0.02, depth 16")["samples"]);
  EXPECT_LE(named.at("adaptive:0.02, depth 16")["believed_rmse"], 0.02);
  if (run["reference"]["precision"] == "double") {
    EXPECT_LT(change("double"), error("16 samples, depth 16 (base)"))
        << "the same samples, rounded otherwise, differ less than others";
  }
  EXPECT_GT(error("1 sample, depth 16"), error("4 samples, depth 16"));
  EXPECT_GT(error("4 samples, depth 16"), error("64 samples, depth 16"));
  EXPECT_LT(run["reference"]["own_error"], error("16 samples, depth 16 (base)"));
  EXPECT_GT(folder.get("report/accuracy/" + run["reference"]["picture"].get<std::string>()).size(), 0u);
}

// The background alone: every setting has the reference's very picture, and a logarithmic axis nothing to
// show.
TEST(BenchAccuracy, ThereIsNoErrorWhereThereIsNothingToSee) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Json json = run_on(
      folder, "v\nfrom 0 -6 3\nat 0 0 1\nup 0 0 1\nangle 40\nhither 0.1\nresolution 8 8\nb 0.5 0.25 2\n",
      {"--quick", "--no-povray"});
  const Json& run = json["runs"][0];
  EXPECT_EQ(run["reference"]["own_error"], 0);
  std::size_t n_front = 0;
  for (const Json& p : run["points"]) {
    for (const auto& [key, value] : p["error"].items()) EXPECT_EQ(value, 0) << p["name"] << " " << key;
    n_front += p["on_front"].get<bool>();
  }
  EXPECT_EQ(n_front, 1u);
  const std::string svg = folder.get("report/accuracy.svg");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(BenchAccuracy, HoldsPovrayAgainstTheSameReferenceWhereItShowsTheSame) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Json json = run_on(folder, kMirrors, {"--quick"});
  const Json& povray = json["runs"][0]["povray"];
  if (povray.is_null()) GTEST_SKIP() << "povray is not installed";
  expect_keys(povray, {"model_difference", "has_own_reference", "points"});
  EXPECT_FALSE(povray["has_own_reference"]) << povray["model_difference"];
  ASSERT_EQ(povray["points"].size(), 2u);
  for (const Json& p : povray["points"]) {
    expect_keys(p, {"name", "seconds", "error", "on_front", "picture", "kdray", "times_kdray"});
    EXPECT_GT(p["error"]["rmse"], 0) << p["name"];
  }
  EXPECT_LT(povray["points"][1]["error"]["rmse"], povray["points"][0]["error"]["rmse"]);
}

TEST(BenchAccuracy, RefusesWhatItDoesNotKnow) {
  EXPECT_TRUE(fails_with(kdray({"bench", "accuracy", "--reference-samples", "100"}), 2, "a multiple of 32"));
  EXPECT_TRUE(fails_with(kdray({"bench", "accuracy", "--reference-samples", "0"}), 2, "--reference-samples"));
  EXPECT_TRUE(fails_with(kdray({"bench", "accuracy", "--size", "big"}), 2, "--size"));
  EXPECT_TRUE(fails_with(kdray({"bench", "accuracy", "--repeat", "0"}), 2, "--repeat"));
  const Folder folder;
  const auto file = folder.put("file", "");
  EXPECT_TRUE(fails_with(kdray({"bench", "accuracy", "--report", (file / "report").string()}), 1, "file"));
}

}  // namespace
}  // namespace kdray::test
