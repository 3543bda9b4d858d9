#include "cli/stats.h"

#include <sys/resource.h>

#include "cli/output.h"

namespace kdray::cli {

namespace {

// The names of docs/cli.md in their order; what the renderer never reached is 0.
Json all_seconds(const Json& measured, const OwnSeconds& own) {
  Json seconds;
  seconds["cache"] = own.cache;
  seconds["load"] = own.load;
  for (const char* const name : {"build", "flatten", "upload", "compile", "trace", "shade", "render"})
    seconds[name] = measured.value(name, 0.0);
  for (const auto& [name, value] : measured.items())
    if (!seconds.contains(name)) seconds[name] = value;
  seconds["write"] = own.write;
  seconds["total"] = own.total;
  return seconds;
}

}  // namespace

Json collect_stats(const std::string& command, const std::string& scene,
                   const std::string& renderer_statistics, const OwnSeconds& seconds) {
  const Json renderer = Json::parse(renderer_statistics);
  Json stats;
  stats["kdray"] = KDRAY_VERSION;
  stats["command"] = command;
  stats["scene"]["file"] = scene;
  if (const auto facts = renderer.find("scene"); facts != renderer.end()) stats["scene"].update(*facts);
  stats["seconds"] = all_seconds(renderer.value("seconds", Json::object()), seconds);
  for (const auto& [name, value] : renderer.items())
    if (!stats.contains(name)) stats[name] = value;
  stats["memory"]["process_peak_bytes"] = peak_memory();
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
