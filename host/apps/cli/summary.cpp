#include "apps/cli/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "apps/cli/output.h"
#include "apps/cli/progress.h"

namespace kdray::cli {

namespace {

// The work that a first start has and the next one does not, as statistics call it, and in words.
constexpr std::array<std::pair<const char*, const char*>, 5> kStart = {{{"start", "opening the device"},
                                                                        {"self_test", "its self-test"},
                                                                        {"compile", "compiling kernels"},
                                                                        {"prepare", "their first launch"},
                                                                        {"keep_programs", "keeping them"}}};
constexpr double kCold = 1, kWorthTelling = 0.05;  // seconds

constexpr double kGlassWorthTelling = 0.002;  // of the eye rays
constexpr double kDeepest = 64;               // that --depth may be

const Json& part(const Json& stats, const char* name) {
  static const Json kNothing = Json::object();
  const auto found = stats.find(name);
  return found != stats.end() && found->is_object() ? *found : kNothing;
}

double number(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
}

// Within a frame, trace is a part of render: a line with both would count it twice. A query has only trace.
const char* work_of(const Json& seconds) {
  return number(seconds, "render") > 0 ? "render" : "trace";
}

// "41% of 2.3 M shadow rays" were not traced; empty when all were.
std::string share_of(double skipped, double traced, const char* what) {
  if (!(skipped > 0)) return "";
  const double all = skipped + traced, percent = 100 * skipped / all;
  return fmt::format("{} of {} {} rays", percent < 1 ? "under 1%" : fmt::format("{:.0f}%", percent),
                     in_words(all), what);
}

std::vector<std::string> names_in(const Json& object, const char* key) {
  std::vector<std::string> names;
  if (const auto list = object.find(key); list != object.end() && list->is_array())
    for (const Json& name : *list)
      if (name.is_string()) names.push_back(name.get<std::string>());
  return names;
}

// "no cones, no spot": what neither the scene nor its programs have.
std::string features_left_out(const Json& stats) {
  std::vector<std::string> off = names_in(part(stats, "features"), "off");
  for (const std::string& spare : names_in(part(stats, "programs"), "spare")) std::erase(off, spare);
  for (std::string& name : off) name = "no " + name;
  return fmt::format("{}", fmt::join(off, ", "));
}

// "kernels kept from another scene, which also have discs, spot"
std::string spare_in_words(const Json& programs) {
  const std::vector<std::string> spare = names_in(programs, "spare");
  if (spare.empty()) return "";
  return fmt::format("kernels {}, which also have {}",
                     number(programs, "compiled") > 0 ? "compiled for any scene" : "kept from another scene",
                     fmt::join(spare, ", "));
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

// "1024x1024 of 4 samples", "512x512 of 3.2 samples"
std::string picture_in_words(const Json& stats) {
  const Json& frame = part(stats, "frame");
  const double adaptive = number(part(stats, "samples"), "per_pixel");
  const double samples = adaptive > 0 ? adaptive : number(frame, "samples");
  const bool is_whole = samples == std::floor(samples);
  return fmt::format("{}x{}{}", number(frame, "width"), number(frame, "height"),
                     samples > 1 ? fmt::format(" of {:.{}g} samples", samples, is_whole ? 17 : 3) : "");
}

// `trace` may be asked about points, too.
const char* what_was_asked(const Json& stats) {
  return part(stats, "hits").contains("points") ? "points" : "rays";
}

// "in 130 ms, 33 Mrays/s; 0.45 s in all"
std::string speed_in_words(const Json& stats) {
  const Json& seconds = part(stats, "seconds");
  return fmt::format("in {}, {:.3g} M{}/s; {} in all", seconds_in_words(number(seconds, work_of(seconds))),
                     number(stats, "mrays_per_s"), what_was_asked(stats),
                     seconds_in_words(number(seconds, "total")));
}

// "3 of 5 rays hit", "12 crossings of 5 rays"
std::string answers_in_words(const Json& hits) {
  const double found = number(hits, "hits"), rays = number(hits, "rays"), points = number(hits, "points");
  const std::string asked = hits.value("asked", "closest");
  if (asked == "all") return fmt::format("{} hits of {} rays", found, rays);
  if (asked == "count") return fmt::format("{} crossings of {} rays", found, rays);
  if (asked == "closest_point") return fmt::format("closest points of {} of {} points", found, points);
  if (asked == "inside" || asked == "signed_distance")
    return fmt::format("{} of {} points inside", found, points);
  return fmt::format("{} of {} rays hit", found, rays);
}

void say_if_any(const std::string& line) {
  if (!line.empty()) say(line);
}

void print_details(const Json& stats) {
  say(stages_line(stats));
  say(rays_line(stats));
  say_if_any(left_out_line(stats));
  say_if_any(samples_line(stats));
}

}  // namespace

std::string stages_line(const Json& stats) {
  const Json& seconds = part(stats, "seconds");
  std::vector<std::string> stages;
  if (const double s = number(seconds, "cache"); s > 0)
    stages.push_back(fmt::format("cache {} {}", stats.value("cache", "off"), seconds_in_words(s)));
  for (const char* const name : {"load", "start", "self_test", "build", "flatten", "upload", "compile",
                                 "prepare", work_of(seconds), "keep_programs", "write"})
    if (const double s = number(seconds, name); s > 0)
      stages.push_back(fmt::format("{} {}", name, seconds_in_words(s)));
  return fmt::format("{}; {} in all", fmt::join(stages, ", "), seconds_in_words(number(seconds, "total")));
}

std::string rays_line(const Json& stats) {
  const Json& rays = part(stats, "rays");
  std::vector<std::string> kinds;
  for (const char* const name : {"primary", "shadow", "reflected", "refracted"})
    if (const double n = number(rays, name); n > 0) kinds.push_back(fmt::format("{} {}", in_words(n), name));
  const char* const of = what_was_asked(stats);
  return fmt::format("{} {}{}{}: {:.3g} M{}/s", in_words(number(rays, "total")), of,
                     kinds.empty() ? "" : ", ", fmt::join(kinds, ", "), number(stats, "mrays_per_s"), of);
}

std::string left_out_line(const Json& stats) {
  const Json& mode = part(stats, "mode");
  const double programs = number(mode, "programs"), known = number(mode, "programs_known");
  const double too_deep = number(part(part(stats, "rays"), "skipped"), "too_deep");
  std::vector<std::string> parts = {
      features_left_out(stats), spare_in_words(part(stats, "programs")),
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

std::string render_line(const Json& stats) {
  return fmt::format("{}: {}, {} rays {}", fmt::join(stats.value("files", std::vector<std::string>()), ", "),
                     picture_in_words(stats), in_words(number(part(stats, "rays"), "total")),
                     speed_in_words(stats));
}

std::string trace_line(const Json& stats) {
  const Json& hits = part(stats, "hits");
  return fmt::format("{}: {}, {}", hits.value("file", ""), answers_in_words(hits), speed_in_words(stats));
}

std::string cold_start_line(const Json& stats) {
  const Json& seconds = part(stats, "seconds");
  double sum = 0;
  std::vector<std::string> parts;
  for (const auto& [key, words] : kStart) {
    const double s = number(seconds, key);
    if (s >= kWorthTelling) parts.push_back(fmt::format("{} {}", words, seconds_in_words(s)));
    sum += s;
  }
  if (number(seconds, "compile") < kCold || parts.empty()) return {};
  return fmt::format("a first start took {} of it ({}){}", seconds_in_words(sum), fmt::join(parts, ", "),
                     keeps_kernels() ? "; the next finds the kernels built" : "");
}

std::string glass_line(const Json& stats) {
  const Json& rays = part(stats, "rays");
  const double depth = number(part(stats, "frame"), "depth"), eye_rays = number(rays, "primary");
  const double cut = number(part(rays, "skipped"), "too_deep_in_glass");
  if (!(cut > kGlassWorthTelling * eye_rays) || depth >= kDeepest) return {};
  return fmt::format(
      "glass behind glass is black where {} rays would have gone deeper than --depth {}; try --depth {}",
      in_words(cut), depth, std::min(2 * depth, kDeepest));
}

std::string missed_target_line(const Json& stats) {
  const Json& samples = part(stats, "samples");
  const bool missed = samples.value("mode", "") == "adaptive" && samples.value("stopped", "") != "target";
  return missed ? samples_line(stats) : "";
}

void print_render_summary(const Json& stats, std::size_t nan_values, bool verbose, bool is_first) {
  say(render_line(stats));
  if (is_first) say_if_any(cold_start_line(stats));
  say_if_any(glass_line(stats));
  if (verbose)
    print_details(stats);
  else
    say_if_any(missed_target_line(stats));
  if (nan_values > 0) say(fmt::format("{} values of the picture are not numbers", nan_values));
}

void print_trace_summary(const Json& stats, bool verbose) {
  say(trace_line(stats));
  say_if_any(cold_start_line(stats));
  if (verbose) print_details(stats);
}

}  // namespace kdray::cli
