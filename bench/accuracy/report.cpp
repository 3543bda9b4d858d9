#include "bench/accuracy/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "accel/prepare/prepared.h"
#include "api/record.h"
#include "bench/accuracy/answers.h"

namespace kdray::bench {

namespace {

const char* precision_of(const AccuracyRun& run) {
  return run.reference_is_exact ? "exact" : run.reference_in_double ? "double" : "float";
}

// How many times as long a point takes as the fastest of kdray's that is no worse.
struct Match {
  const AccuracyPoint* kdray;
  double times;
};
std::optional<Match> match_of(const AccuracyRun& run, const AccuracyPoint& point) {
  const AccuracyPoint* const k = fastest_within(run.points, point.error.rmse);
  if (k == nullptr || !(k->seconds.median > 0)) return std::nullopt;
  return Match{k, point.seconds.median / k->seconds.median};
}

std::string row_of(const AccuracyPoint& p, double base_seconds) {
  const double times = base_seconds > 0 ? p.seconds.median / base_seconds : 1;
  const std::string change = p.group == kPovray ? "" : fmt::format("{:.2e}", p.change);
  const std::string taken =
      p.taken ? fmt::format("{:>11.2e}{:>8.2f}", p.taken->believed, p.taken->per_pixel) : "";
  return fmt::format("  {} {:<35}{:>10.2f}{:>8.2f}{:>11.2e}{:>10.4f}{:>9.3f}{:>9.5f}{:>11}{}",
                     p.on_front ? '*' : ' ', p.name, 1e3 * p.seconds.median, times, p.error.rmse, p.error.max,
                     100 * p.error.differing_share, p.error.flip, change, taken);
}

Json json_of(const image::Difference& d) {
  return {{"rmse", d.rmse},
          {"mean_absolute", d.mean_absolute},
          {"max", d.max},
          {"differing_share", d.differing_share},
          {"flip", d.flip}};
}

Json point_json(const AccuracyRun& run, const AccuracyPoint& p) {
  return {{"group", p.group},
          {"name", p.name},
          {"label", p.label},
          {"seconds", json_of(p.seconds)},
          {"error", json_of(p.error)},
          {"on_front", p.on_front},
          {"picture", picture_name(run.scene, p.group == kPovray ? "POV-Ray " + p.name : p.name)}};
}

Json kdray_json(const AccuracyRun& run, const AccuracyPoint& p) {
  Json json = point_json(run, p);
  const Setting& s = p.setting;
  json["change"] = p.change;
  json["samples"] = p.taken ? Json(p.taken->per_pixel) : Json(s.samples);
  json["adaptive_target"] = p.taken ? Json(s.adaptive_target) : Json();
  json["believed_rmse"] = p.taken ? Json(p.taken->believed) : Json();
  json["depth"] = s.depth, json["min_weight"] = s.min_weight;
  json["light_reach"] = s.light_reach > 0 ? Json(s.light_reach) : Json();
  json["traversal"] = api::name_of(s.traversal);
  json["precision"] = api::name_of(s.precision);
  json["build"] = prepare::name_of(s.quality);
  return json;
}

Json povray_json(const AccuracyRun& run) {
  if (!run.povray) return Json();
  const auto point = [&](const AccuracyPoint& p) {
    Json json = point_json(run, p);
    const auto match = match_of(run, p);
    json["kdray"] = match ? Json(match->kdray->name) : Json();
    json["times_kdray"] = match ? Json(match->times) : Json();
    return json;
  };
  return {{"model_difference", json_of(run.povray->model_difference)},
          {"has_own_reference", run.povray->has_own_reference},
          {"points", json_list(run.povray->points, point)}};
}

// One line: in what share of the base's time, and how many times as long POV-Ray takes.
std::string answers_of(const AccuracyRun& run) {
  if (std::none_of(run.points.begin(), run.points.end(), [](const auto& p) { return is_adaptive(p.group); }))
    return "";
  const AdaptiveAnswers a = adaptive_answers(run);
  std::string out =
      a.share_of_base ? fmt::format("  adaptive has the base's RMSE in {:.2f} of its time", *a.share_of_base)
                      : std::string("  adaptive does not come as near as the base");
  if (a.povray != nullptr)
    out += fmt::format("; POV-Ray's best at equal RMSE, {}, takes {:.1f} times as long", a.povray->name,
                       a.times_povray);
  else if (run.povray)
    out += "; all of POV-Ray's points are nearer to the reference";
  return out + "\n";
}

Json answers_json(const AccuracyRun& run) {
  const AdaptiveAnswers a = adaptive_answers(run);
  return {{"share_of_base", json_if(a.share_of_base)},
          {"povray", a.povray != nullptr ? Json(a.povray->name) : Json()},
          {"times_povray", a.povray != nullptr ? Json(a.times_povray) : Json()}};
}

}  // namespace

std::string picture_name(const std::string& scene, const std::string& name) {
  std::string file = short_name(scene) + "_" + name;
  std::string clean;
  for (const char c : file) {
    const bool keep = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+';
    if (keep)
      clean += c;
    else if (!clean.empty() && clean.back() != '_')
      clean += '_';
  }
  while (!clean.empty() && clean.back() == '_') clean.pop_back();
  return clean + ".png";
}

std::string table_of(const AccuracyRun& run) {
  std::string out = fmt::format(
      "{}: {} primitives, {}; the reference in {} took {:.1f} s and has an RMSE of {:.1e} itself\n"
      "    {:<35}{:>10}{:>8}{:>11}{:>10}{:>9}{:>9}{:>11}{:>11}{:>8}\n",
      short_name(run.scene), run.n_primitives, counted(run.machine.cores, "core"), precision_of(run),
      run.reference_seconds, run.reference_error, "* on the front", "ms", "x base", "RMSE", "max", "% >1/255",
      "FLIP", "from base", "believed", "spp");
  const double base = run.points.front().seconds.median;
  for (const AccuracyPoint& p : run.points) out += row_of(p, base) + "\n";
  if (!run.povray) return out + answers_of(run);
  out += fmt::format(
      "  POV-Ray, against {} reference; with one ray through each pixel's centre an RMSE of {:.1e} from "
      "kdray's\n",
      run.povray->has_own_reference ? "its own" : "the same", run.povray->model_difference.rmse);
  for (const AccuracyPoint& p : run.povray->points) {
    const auto match = match_of(run, p);
    out += row_of(p, base) +
           (match ? fmt::format("{:>7.1f} times as long as kdray's {}\n", match->times, match->kdray->name)
                  : std::string("  no point of kdray's is as near\n"));
  }
  return out + answers_of(run);
}

Json json_of(std::span<const AccuracyRun> runs, const AccuracyOptions& options) {
  const auto of_run = [](const AccuracyRun& run) -> Json {
    return {{"scene", run.scene},
            {"primitives", run.n_primitives},
            {"cores", run.machine.cores},
            {"device", run.machine.device},
            {"vectors", run.machine.vectors},
            {"reference",
             {{"seconds", run.reference_seconds},
              {"own_error", run.reference_error},
              {"precision", precision_of(run)},
              {"picture", picture_name(run.scene, "reference")}}},
            {"points", json_list(run.points, [&](const AccuracyPoint& p) { return kdray_json(run, p); })},
            {"povray", povray_json(run)},
            {"adaptive", answers_json(run)}};
  };
  return {{"command", "bench accuracy"},
          {"size", {options.width, options.height}},
          {"repeat", options.repeat},
          {"reference_samples", options.reference_samples},
          {"unlike_base", count_unlike_base(runs)},
          {"runs", json_list(runs, of_run)}};
}

}  // namespace kdray::bench
