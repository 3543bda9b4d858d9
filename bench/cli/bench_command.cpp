#include "bench/cli/bench_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>

#include "apps/cli/output.h"
#include "base/write_file.h"
#include "bench/embree/embree.h"
#include "bench/measure/run_program.h"
#include "bench/workload/scenes.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

constexpr int kHasSaidWhy = 3;  // exit code of the script

void draw(const std::string& report) {
  std::error_code none;
  const auto script =
      std::filesystem::read_symlink("/proc/self/exe", none).replace_filename("kdray-bench-plot");
  if (!std::filesystem::exists(script))
    return say("no plot: " + script.string() + " is missing; install it anew beside kdray-bench");
  const int code = bench::run_program({"python3", script.string(), report});
  if (code == bench::kNotRun)
    say("no plot: there is no python3; the figures are in " + report);
  else if (code != 0 && code != kHasSaidWhy)
    say("no plot: " + script.string() + " failed; the figures are in " + report);
}

}  // namespace

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw input_error(folder.string(), 0, "can't be made a folder: " + error.message(),
                      "choose another --report");
}

void prepare_report(const std::string& folder, const std::string& name) {
  if (folder.empty()) return;
  make_folder(folder);
  for (const char* const ending : {".json", ".svg"})
    check_writable(std::filesystem::path(folder) / (name + ending));
}

void write_report(const std::string& folder, const std::string& name, const bench::Json& json) {
  if (folder.empty()) return;
  const std::string file = (std::filesystem::path(folder) / (name + ".json")).string();
  write_file(file, json.dump(2, ' ', false, bench::Json::error_handler_t::replace) + "\n");
  draw(file);
}

void print_table(const std::string& table) {
  std::fprintf(stderr, "%s\n", table.c_str());
}

void say_working(const std::string& what) {
  say(what);
}

void say_without_embree() {
  if (bench::embree_versions().empty())
    say("no Embree is found (Debian: libembree3-3; or KDRAY_EMBREE=FILE): its columns are left out");
}

void require_none(std::size_t n, const std::string& what) {
  if (n > 0) throw Error(ErrorCode::internal, fmt::format("{} {}", n, what));
}

void add_scenes(CLI::App& app, std::vector<std::string>& scenes) {
  add_scenes(app, scenes, fmt::format("{}", fmt::join(scenes, " ")));
}

void add_scenes(CLI::App& app, std::vector<std::string>& scenes, const std::string& default_scenes) {
  app.add_option("SCENE", scenes,
                 "Scene files, or names of built-in scenes (default: " + default_scenes + ")")
      ->type_name("");
}

void add_rays(CLI::App& app, int& rays) {
  add_int(app, "--rays", fmt::format("Rays of a class, as a square picture holds them (default {})", rays), 1,
          kRaysMax, rays);
}

void add_depth(CLI::App& app, int& depth) {
  add_int(app, "--depth", fmt::format("Deepest ray; the eye ray is 1 (default {})", depth), 1, 64, depth);
}

void add_picture_size(CLI::App& app, long long pixels_max, int& width, int& height) {
  add_size(app, fmt::format("Pixels across and down (default {}x{})", width, height), kSideMax, pixels_max,
           width, height);
}

void add_no_embree(CLI::App& app, bool& embree) {
  app.add_flag_callback(
      "--no-embree", [&embree] { embree = false; }, "Leave Embree out");
}

void add_repeat_and_device(CLI::App& app, int& repeat, std::string& device) {
  add_int(app, "--repeat", fmt::format("Rounds to take the median of (default {})", repeat), 1, kRepeatMax,
          repeat);
  add_device_option(app, "The device, as for render (default: auto)", device);
}

void add_report(CLI::App& app, std::string& report) {
  app.add_option("--report", report,
                 "A folder for the figures (JSON) and a plot (SVG, with python3-matplotlib)")
      ->type_name("DIR");
}

void require_scenes(const std::vector<std::string>& scenes) {
  for (const std::string& name : scenes) bench::require_scene(name);
}

}  // namespace kdray::cli
