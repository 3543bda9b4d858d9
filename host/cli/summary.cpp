#include "cli/summary.h"

#include <fmt/format.h>

#include <vector>

#include "cli/message.h"

namespace kdray::cli {

namespace {

const Json& part(const Json& stats, const char* name) {
  static const Json kNothing = Json::object();
  const auto found = stats.find(name);
  return found != stats.end() && found->is_object() ? *found : kNothing;
}

double number(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
}

std::string readable(std::string name) {
  for (char& c : name)
    if (c == '_') c = ' ';
  return name;
}

// Counts under rays.skipped, however deep they are grouped.
void list_skipped(const Json& node, const std::string& name, std::vector<std::string>& out) {
  if (node.is_object())
    for (const auto& [key, value] : node.items())
      list_skipped(value, name.empty() ? key : name + " " + key, out);
  else if (node.is_number() && node.get<double>() > 0)
    out.push_back(fmt::format("{} {}", in_words(node.get<double>()), readable(name)));
}

void print_common(const Json& stats) {
  say(stages_line(stats));
  say(rays_line(stats));
  if (const std::string left_out = left_out_line(stats); !left_out.empty()) say(left_out);
}

}  // namespace

std::string stages_line(const Json& stats) {
  const Json& seconds = part(stats, "seconds");
  std::vector<std::string> stages;
  // Within a frame, trace is a part of render: the line would count it twice. A query has only trace.
  const char* const work = number(seconds, "render") > 0 ? "render" : "trace";
  if (const double s = number(seconds, "cache"); s > 0)
    stages.push_back(fmt::format("cache {} {}", stats.value("cache", "off"), seconds_in_words(s)));
  for (const char* const name : {"load", "build", "flatten", "upload", "compile", work, "write"})
    if (const double s = number(seconds, name); s > 0)
      stages.push_back(fmt::format("{} {}", name, seconds_in_words(s)));
  return fmt::format("{}; {} in all", fmt::join(stages, ", "), seconds_in_words(number(seconds, "total")));
}

std::string rays_line(const Json& stats) {
  const Json& rays = part(stats, "rays");
  std::vector<std::string> kinds;
  for (const char* const name : {"primary", "shadow", "reflected", "refracted"})
    if (const double n = number(rays, name); n > 0) kinds.push_back(fmt::format("{} {}", in_words(n), name));
  return fmt::format("{} rays{}{}: {:.3g} Mrays/s", in_words(number(rays, "total")),
                     kinds.empty() ? "" : ", ", fmt::join(kinds, ", "), number(stats, "mrays_per_s"));
}

std::string left_out_line(const Json& stats) {
  std::vector<std::string> skipped, off;
  list_skipped(part(part(stats, "rays"), "skipped"), "", skipped);
  const Json& features = part(stats, "features");
  if (const auto names = features.find("off"); names != features.end() && names->is_array())
    for (const Json& name : *names)
      if (name.is_string()) off.push_back(readable(name.get<std::string>()));
  std::string line;
  if (!skipped.empty()) line = fmt::format("rays not traced: {}", fmt::join(skipped, ", "));
  if (!off.empty()) line += fmt::format("{}not compiled: {}", line.empty() ? "" : "; ", fmt::join(off, ", "));
  return line;
}

void print_render_summary(const Json& stats, std::size_t nan_values) {
  const Json& frame = part(stats, "frame");
  const double samples = number(frame, "samples");
  say(fmt::format("{} primitives, {}x{} pixels{}, depth {}: {}", number(part(stats, "scene"), "primitives"),
                  number(frame, "width"), number(frame, "height"),
                  samples > 1 ? fmt::format(" of {} samples", samples) : "", number(frame, "depth"),
                  fmt::join(stats.value("files", std::vector<std::string>()), ", ")));
  print_common(stats);
  if (nan_values > 0) say(fmt::format("{} values of the picture are not numbers", nan_values));
}

void print_trace_summary(const Json& stats, const std::string& hits_file, std::size_t rays,
                         std::size_t hits) {
  say(fmt::format("{} of {} rays hit: {}", hits, rays, hits_file));
  print_common(stats);
}

}  // namespace kdray::cli
