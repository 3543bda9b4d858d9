// What    kdray tune: looks for the settings that render a scene fastest on a device, and keeps them for
//         render and trace.
// Shape   Scenes that share an entry of the database are tuned together; without a scene a built-in set is,
//         for scenes that have no entry of their own. --check then races what was found against what kdray
//         ships with.
// Errors  A database of one's own that is of no use is begun anew, with a warning; one that is named by
//         --merge is an error.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/progress.h"
#include "apps/cli/run_files.h"
#include "apps/cli/stats.h"
#include "apps/cli/tune_lab.h"
#include "device/tuning/database.h"
#include "device/tuning/search.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

constexpr int kTunedSideMax = 8192;
constexpr long long kTunedPixelsMax = 1 << 26;
constexpr int kCheckRounds = 21;
constexpr double kNoSlower = 1.02;
const std::vector<std::string> kBuiltIn = {"balls", "gears", "boxes"};

struct TuneArgs {
  std::vector<std::string> scenes, merge;
  std::string file, stats, t4;
  bool explain = false, check = false, quiet = false;
  int rounds = kCheckRounds;
  tuning::SearchOptions search;
  DeviceOptions device;
  RenderOptions render = {.width = 512, .height = 512};
  Injection injection;
};

void talk(const TuneArgs& o, const std::string& text) {
  if (!o.quiet) say(text);
}

tuning::Database read_own(const TuneArgs& o) {
  try {
    return tuning::Database::read(o.file);
  } catch (const Error& error) {
    talk(o, fmt::format("{}; it is begun anew", error.what()));
    return {};
  }
}

// Adds to what the file has now, which others may have written meanwhile.
void add_to_file(const TuneArgs& o, const tuning::Database& found) {
  tuning::Database all = read_own(o);
  all.merge(found);
  all.write(o.file);
}

int merge_files(const TuneArgs& o) {
  tuning::Database others;
  for (const std::string& file : o.merge) {
    if (!std::filesystem::exists(file)) throw input_error(file, 0, "no such file", "name files of tunings");
    others.merge(tuning::Database::read(file));
  }
  add_to_file(o, others);
  talk(o, fmt::format("{}: {} entries from {} files", o.file, others.entries().size(), o.merge.size()));
  return 0;
}

tuning::Entry entry_of(const Tuned& tuned, tuning::Key key, bool any) {
  using Clock = std::chrono::system_clock;
  if (any) key.features = tuning::kAnyFeatures;
  return {.key = std::move(key),
          .settings = tuned.found.best,
          .ratio = tuned.found.ratio,
          .seconds = tuned.found.seconds,
          .when = std::chrono::duration_cast<std::chrono::seconds>(Clock::now().time_since_epoch()).count(),
          .scenes = tuned.scenes};
}

Tuned tune_group(const TuneArgs& o, TuneScenes& scenes) {
  Tuned tuned;
  for (const auto& scene : scenes) tuned.scenes.push_back(scene->name());
  Progress progress(o.quiet);
  const tuning::Lab lab =
      make_lab(scenes, o.injection, [&progress](double share) { progress.update(share); });
  tuning::SearchOptions search = o.search;
  search.global = scenes.front()->key().schedule == "global";
  tuned.found = tuning::search(lab, {}, search);
  return tuned;
}

std::vector<Checked> check(const TuneArgs& o, std::vector<TuneScenes>& groups,
                           const tuning::Database& found) {
  std::vector<Checked> checked;
  for (TuneScenes& group : groups)
    for (auto& scene : group) {
      Progress progress(o.quiet);
      const tuning::Entry* const entry = found.find(scene->key());
      Checked c{scene->name(), entry ? entry->settings : Tuning{}, {}};
      for (int round = 0; round < o.rounds; ++round) {
        const bool first = round % 2 == 0;
        const double a = scene->seconds(first ? c.settings : Tuning{}),
                     b = scene->seconds(first ? Tuning{} : c.settings);
        c.rival.ratios.push_back(first ? a / b : b / a);
        progress.update(static_cast<double>(round + 1) / o.rounds);
      }
      checked.push_back(std::move(c));
    }
  return checked;
}

// Checks the outputs before a search that would be for nothing.
void check_outputs(const TuneArgs& o, RunFiles& files) {
  if (o.file == "-")
    throw Error(ErrorCode::usage, "--output '-': tunings are added to those of a file; name one");
  for (const std::string& scene : o.scenes) files.read("SCENE", scene);
  for (const std::string& file : o.merge) files.read("--merge", file);
  const std::filesystem::path folder = std::filesystem::path(o.file).parent_path();
  std::error_code error;  // the check of the file tells
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  files.write("--output", o.file);
  files.write("--stats", o.stats);
  files.write("--t4", o.t4);
}

int run(TuneArgs& o) {
  if (o.file.empty()) o.file = tuning::default_file().string();
  if (o.file.empty())
    throw Error(ErrorCode::usage, "there is no home folder to keep tunings in; name a file with --output");
  RunFiles files;
  check_outputs(o, files);
  if (!o.merge.empty()) return merge_files(o);
  o.device.tunings.clear();  // the start is what kdray ships with
  o.device.programs = default_program_folder();
  o.device.exact_programs = true;
  const bool built_in = o.scenes.empty();
  TuneScenes scenes;
  for (const std::string& name : built_in ? kBuiltIn : o.scenes)
    scenes.push_back(std::make_unique<TuneScene>(
        name, o.device, o.render, [&](const scene::Scene& loaded) { files.read_scene(loaded.files); }));
  std::vector<TuneScenes> groups;
  if (built_in)
    groups.push_back(std::move(scenes));
  else
    groups = by_key(std::move(scenes));
  tuning::Database found;
  std::vector<Tuned> tuned;
  for (TuneScenes& group : groups) {
    tuned.push_back(tune_group(o, group));
    found.put(entry_of(tuned.back(), group.front()->key(), built_in));
    talk(o, one_line_of(tuned.back()));
    if (o.explain) print(explain(tuned.back().found));
  }
  add_to_file(o, found);
  const std::vector<Checked> checked = o.check ? check(o, groups, found) : std::vector<Checked>{};
  if (o.check) print(table_of(checked));
  if (!o.stats.empty()) write_stats(o.stats, json_of(tuned, checked));
  if (!o.t4.empty()) write_stats(o.t4, t4_of(tuned));
  // Where nothing was kept there is nothing to be slower: the row shows the machine's noise.
  const auto slower = std::ranges::count_if(
      checked, [](const Checked& c) { return c.settings != Tuning{} && c.rival.ratio() > kNoSlower; });
  if (slower > 0)
    throw Error(ErrorCode::internal,
                fmt::format("{} scenes are slower than with what kdray ships with by over 2 %", slower));
  return 0;
}

// "packets=8"
Injection parse_injection(const std::string& text) {
  const std::size_t equals = text.find('=');
  const tuning::Setting* const setting = tuning::find_setting(text.substr(0, equals));
  if (!setting || equals == std::string::npos)
    throw usage_error("--inject-fault", text, "a setting and a value, as in packets=8");
  return {setting->value, parse_int("--inject-fault", text.substr(equals + 1), 0, 1 << 20)};
}

}  // namespace

Command add_tune(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("tune", "Find the settings that render fastest on a device, and keep them");
  const auto o = std::make_shared<TuneArgs>();
  app->add_option("SCENE", o->scenes,
                  "Scenes to tune for, files or names as for bench (default: a built-in set, for all scenes)")
      ->type_name("");
  add_device_option(*app, "The device, as for render", o->device.device);
  add_schedule_option(*app, "Launches: slices, global, auto; each has entries of its own", o->device);
  add_real(*app, "--budget", "SECONDS", "The most that a search may take, without loading (default 20)", 0.1,
           1e6, o->search.budget);
  add_real(
      *app, "--frames", "N",
      "Frames that the settings are to pay for themselves in: what takes longer isn't tried (default 10000)",
      1, 1e12, o->search.frames);
  add_size(*app, "Pixels across and down (default 512x512)", kTunedSideMax, kTunedPixelsMax, o->render.width,
           o->render.height);
  app->add_flag("--explain", o->explain, "Print what each setting bought, and what else was tried");
  app->add_flag("--check", o->check, "Then race what was found against what kdray ships with");
  add_int(*app, "--rounds", "Rounds of --check (default 21)", 1, 100000, o->rounds);
  app->add_option("--merge", o->merge, "Add these files of tunings to one's own, and search nothing")
      ->type_name("FILE...");
  add_path(*app, "-o,--output", "The file of tunings (default: in the user's data folder)", o->file);
  add_path(*app, "--stats", "Write the search's figures as JSON ('-': to standard output)", o->stats);
  add_path(*app, "--t4", "Write all that was tried in T4, Kernel Tuner's JSON ('-': to standard output)",
           o->t4);
  app->add_flag("-q,--quiet", o->quiet, "Say nothing unless something is wrong");
  add_text(*app, "--inject-fault", "SETTING=VALUE", "For tests: pictures made with this value count as wrong",
           [o](const std::string& text) { o->injection = parse_injection(text); });
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
