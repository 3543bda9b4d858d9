#include "bench/cli/report_files.h"

#include <cstdio>

#include "base/write_file.h"
#include "bench/embree/embree.h"
#include "cli/message.h"
#include "generate/built_in.h"
#include "kdray/error.h"

namespace kdray::cli {

void prepare_report(const std::string& folder, const std::string& name) {
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw input_error(folder, 0, "can't be made a folder: " + error.message(), "choose another --report");
  for (const char* const ending : {".json", ".svg"})
    check_writable(std::filesystem::path(folder) / (name + ending));
}

void write_report(const std::string& folder, const std::string& name, const bench::Json& json,
                  const std::string& svg) {
  if (folder.empty()) return;
  const std::filesystem::path base = std::filesystem::path(folder) / name;
  write_file(base.string() + ".json", json.dump(2, ' ', false, bench::Json::error_handler_t::replace) + "\n");
  write_file(base.string() + ".svg", svg);
}

void write_report(const std::string& folder, const std::string& name, const bench::Json& json,
                  const bench::Plot& plot) {
  write_report(folder, name, json, bench::to_svg(plot));
}

void print_table(const std::string& table) {
  std::fprintf(stderr, "%s\n", table.c_str());
}

void say_without_embree() {
  if (bench::embree_version().empty()) say("this kdray was built without Embree: its columns are left out");
}

void add_report(CLI::App& app, std::string& report) {
  app.add_option("--report", report, "A folder for the figures (JSON) and a plot (SVG)")->type_name("DIR");
}

void add_scenes(CLI::App& app, std::vector<std::string>& scenes, const std::string& default_scenes) {
  app.add_option("SCENE", scenes,
                 "Scene files, or names of built-in scenes (default: " + default_scenes + ")")
      ->type_name("");
}

void require_scenes(const std::vector<std::string>& scenes) {
  for (const std::string& name : scenes) generate::require_scene(name);
}

}  // namespace kdray::cli
