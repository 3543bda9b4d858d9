#include "apps/cli/stats.h"

#include <sys/resource.h>

#include <array>

#include "api/statistics_json.h"
#include "apps/cli/output.h"
#include "base/paged.h"

namespace kdray::cli {

namespace {

constexpr std::array kFirst = {"cache",  "load",    "start",   "self_test", "build", "flatten",
                               "upload", "compile", "prepare", "trace",     "shade", "render"};
constexpr std::array kLast = {"keep_programs", "write", "total", "read_rays"};

// Puts the times into the order of docs/statistics.md, which is about that of the work; those that only one
// command has lie between.
Json in_order(const Json& measured) {
  Json seconds, last;
  for (const char* const name : kFirst) seconds[name] = measured.at(name);
  for (const char* const name : kLast)
    if (const auto found = measured.find(name); found != measured.end()) last[name] = *found;
  for (const auto& [name, value] : measured.items())
    if (!seconds.contains(name) && !last.contains(name)) seconds[name] = value;
  seconds.update(last);
  return seconds;
}

}  // namespace

Json collect_stats(const std::string& command, const std::string& scene, const Statistics& statistics) {
  const Json renderer = api::statistics_json(statistics);
  Json stats;
  stats["kdray"] = KDRAY_VERSION;
  stats["command"] = command;
  stats["scene"]["file"] = scene;
  stats["scene"].update(renderer.at("scene"));
  stats["seconds"] = in_order(renderer.at("seconds"));
  for (const auto& [name, value] : renderer.items())
    if (!stats.contains(name)) stats[name] = value;
  stats["memory"]["process_peak_bytes"] = peak_memory();
  if (const std::uint64_t in_files = paged_bytes().in_files; in_files > 0)
    stats["memory"]["texture_file_bytes"] = in_files;
  return stats;
}

std::uint64_t peak_memory() {
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

void write_stats(const std::filesystem::path& file, const Json& stats) {
  // A file name that is not UTF-8 must not cost the statistics: replaced, not thrown at.
  write_text(file, stats.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace kdray::cli
