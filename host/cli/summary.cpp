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

// "41% of 2.3 M shadow rays" were not traced; empty when all were.
std::string share_of(double skipped, double traced, const char* what) {
  if (!(skipped > 0)) return "";
  const double all = skipped + traced, percent = 100 * skipped / all;
  return fmt::format("{} of {} {} rays", percent < 1 ? "under 1%" : fmt::format("{:.0f}%", percent),
                     in_words(all), what);
}

// "no cones, no spot"
std::string features_left_out(const Json& features) {
  std::vector<std::string> off;
  if (const auto names = features.find("off"); names != features.end() && names->is_array())
    for (const Json& name : *names)
      if (name.is_string()) off.push_back("no " + name.get<std::string>());
  return fmt::format("{}", fmt::join(off, ", "));
}

// "41% of 2.3 M shadow rays and 3% of 1 M secondary rays proven needless"
std::string rays_left_out(const Json& rays) {
  const Json& skipped = part(rays, "skipped");
  std::vector<std::string> shares = {
      share_of(number(skipped, "light_behind") + number(skipped, "light_of_no_weight") +
                   number(skipped, "light_in_the_open"),
               number(rays, "shadow"), "shadow"),
      share_of(number(skipped, "below_min_weight") + number(skipped, "of_the_background"),
               number(rays, "reflected") + number(rays, "refracted"), "secondary")};
  std::erase(shares, "");
  return shares.empty() ? "" : fmt::format("{} proven needless", fmt::join(shares, " and "));
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
  const Json& mode = part(stats, "mode");
  const double programs = number(mode, "programs"), known = number(mode, "programs_known");
  const double too_deep = number(part(part(stats, "rays"), "skipped"), "too_deep");
  std::vector<std::string> parts = {
      features_left_out(part(stats, "features")),
      known > programs ? fmt::format("{} of {} programs built", programs, known) : "",
      rays_left_out(part(stats, "rays")), too_deep > 0 ? in_words(too_deep) + " rays too deep" : ""};
  std::erase(parts, "");
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::string samples_line(const Json& stats) {
  const Json& samples = part(stats, "samples");
  if (samples.value("mode", "") != "adaptive") return {};
  const bool met = samples.value("stopped", "") == "target";
  return fmt::format(
      "{:.3g} samples per pixel in {} rounds; error believed to be {:.2g} RMSE, {} the target of {}",
      number(samples, "per_pixel"), number(samples, "rounds"), number(samples, "estimated_rmse"),
      met ? "within" : "all that helps is done, above", number(samples, "target"));
}

void print_render_summary(const Json& stats, std::size_t nan_values) {
  const Json& frame = part(stats, "frame");
  const double samples = number(frame, "samples");
  say(fmt::format("{} primitives, {}x{} pixels{}, depth {}: {}", number(part(stats, "scene"), "primitives"),
                  number(frame, "width"), number(frame, "height"),
                  samples > 1 ? fmt::format(" of {} samples", samples) : "", number(frame, "depth"),
                  fmt::join(stats.value("files", std::vector<std::string>()), ", ")));
  print_common(stats);
  if (const std::string samples = samples_line(stats); !samples.empty()) say(samples);
  if (nan_values > 0) say(fmt::format("{} values of the picture are not numbers", nan_values));
}

void print_trace_summary(const Json& stats, const std::string& hits_file, std::size_t rays,
                         std::size_t hits) {
  say(fmt::format("{} of {} rays hit: {}", hits, rays, hits_file));
  print_common(stats);
}

}  // namespace kdray::cli
