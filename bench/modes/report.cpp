#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "bench/modes/bench.h"

namespace kdray::bench {

namespace {

const std::vector<std::string> kBalances = {"odprt sah", "odprt pilot", "odprt dynamic"};

std::optional<double> times(const std::optional<double>& value, double factor) {
  if (!value) return std::nullopt;
  return *value * factor;
}

std::optional<double> median_of(const std::optional<Spread>& spread) {
  if (!spread) return std::nullopt;
  return spread->median;
}

std::string line_of(const ModesRun& run, const ModesRow& row) {
  return fmt::format(
      "  {:>6}{} {:<21}{:>9.4f}{:>9.4f}{:>9.4f}{}{}{}{}{}{}\n", row.queues, row.shares_cores() ? '*' : ' ',
      row.scheme, row.seconds.median, row.seconds.min, row.seconds.max, cell(run.speed_up(row), 10, 2),
      cell(times(median_of(row.idle_share), 100), 8, 1), cell(times(row.rays_exchanged, 1e-6), 9, 2),
      cell(times(row.bytes_exchanged, 1e-6), 9, 1), cell(times(row.geometry_share, 100), 9, 1),
      cell(times(row.work_bytes, 1e-6), 9, 1));
}

// Rows that failed, those of one message in one line.
std::string failures_of(const ModesRun& run) {
  std::map<std::string, std::string> by_message;
  for (const ModesRow& row : run.rows)
    if (!row.failure.empty())
      by_message[row.failure] +=
          fmt::format("{}{} on {}", by_message[row.failure].empty() ? "" : ", ", row.scheme, row.queues);
  std::string out;
  for (const auto& [message, rows] : by_message) out += fmt::format("  failed: {}: {}\n", rows, message);
  return out;
}

// The fewest queues within 1% of the shortest time; nullptr where there is no prediction.
const Prediction* fastest(const Model& model, const std::string& scheme) {
  const Prediction* best = nullptr;
  for (const Prediction& p : model.predictions)
    if (p.scheme == scheme && (best == nullptr || p.seconds < 0.99 * best->seconds)) best = &p;
  return best;
}

std::string model_table(const ModesRun& run, const ModelOptions& options) {
  const Model& model = *run.model;
  std::string out = fmt::format(
      "  simulation, not measured: efficiency in % of one core's time; links of {:g} GB/s, {:g} us; a sample "
      "ray stands for {:.4g}\n  {:>7}{:>12}{:>13}{:>8}{:>12}{:>13} |{:>9}{:>10}{:>12}{:>11}{:>10}\n",
      options.gigabytes_per_second, options.latency_us, model.rays_per_sample, "queues", "contiguous",
      "interleaved", "bag", "odprt sah", "odprt pilot", "balance", "port us", "longest us", "sent/ray",
      "geometry");
  std::set<int> queues;
  for (const Prediction& p : model.predictions) queues.insert(p.queues);
  double rays = 0;
  for (const SampledRays& r : model.rays) rays += r.sampled;
  for (const int n : queues) {
    const auto efficiency = [&](const char* scheme) -> std::optional<double> {
      const Prediction* const p = model.find(scheme, n);
      if (p == nullptr) return std::nullopt;
      return 100 * p->efficiency;
    };
    out += fmt::format("  {:>7}{}{}{}{}{}", n, cell(efficiency("pdprt contiguous"), 12, 1),
                       cell(efficiency("pdprt interleaved"), 13, 1), cell(efficiency("pdprt bag"), 8, 1),
                       cell(efficiency("odprt sah"), 12, 1), cell(efficiency("odprt pilot"), 13, 1));
    if (const Prediction* const p = model.find("odprt pilot", n))
      out += fmt::format(" |{:>9.1f}{:>10.1f}{:>12.1f}{:>11.2f}{:>10.2f}", 100 * p->balance,
                         1e6 * p->port_seconds, 1e6 * p->critical_path, p->rays_sent / std::max(1.0, rays),
                         100 * p->largest_geometry);
    out += "\n";
  }
  for (const Check& c : checks_of(run))
    out += fmt::format("  checked: {:<18}{:>3} queue{} {} predicted {:.4g}, measured {:.4g}, {:+.1f}%\n",
                       c.scheme, c.queues, c.queues == 1 ? ": " : "s:", c.what, c.predicted, c.measured,
                       100 * c.error());
  out += "  at best:";
  for (const char* const scheme : {"pdprt bag", "odprt pilot"})
    if (const Prediction* const p = fastest(model, scheme))
      out += fmt::format(" {} {:.1f} times one core, on {} queues;", scheme, p->efficiency * p->queues,
                         p->queues);
  out.back() = '\n';
  if (model.tile_width == 0) out += "  no PDPRT predictions: the statistics have no tile_seconds\n";
  out += fmt::format("  ODPRT's own overhead, on one queue: {:.3f}{}\n", model.odprt_overhead,
                     model.overhead_measured ? ", measured" : ", assumed: not measured");
  return out;
}

Json json_of(const ModesRun& run, const ModesRow& row) {
  return {{"scheme", row.scheme},
          {"queues", row.queues},
          {"sub_devices", row.sub_devices},
          {"shares_cores", row.shares_cores()},
          {"failure", row.failure.empty() ? Json() : Json(row.failure)},
          {"seconds", row.rounds.empty() ? Json() : json_of(row.seconds)},
          {"rounds", row.rounds},
          {"speed_up", json_if(run.speed_up(row))},
          {"idle_share", json_if(row.idle_share)},
          {"busy_seconds", json_if(row.busy_seconds)},
          {"rays_exchanged", json_if(row.rays_exchanged)},
          {"bytes_exchanged", json_if(row.bytes_exchanged)},
          {"geometry_bytes", json_if(row.geometry_bytes)},
          {"geometry_share", json_if(row.geometry_share)},
          {"work_bytes", json_if(row.work_bytes)},
          {"timeline", row.timeline.empty() ? Json() : Json::parse(row.timeline)},
          {"differing_pixels", row.differing_pixels}};
}

Json json_of(const Prediction& p) {
  Json json = {
      {"scheme", p.scheme}, {"queues", p.queues}, {"seconds", p.seconds}, {"efficiency", p.efficiency}};
  if (p.tiles > 0) json["tiles"] = p.tiles;
  if (p.subtrees > 0) {
    json["subtrees"] = p.subtrees;
    json["balance"] = p.balance;
    json["port_seconds"] = p.port_seconds;
    json["critical_path_seconds"] = p.critical_path;
    json["rays_sent"] = p.rays_sent;
    json["bytes_sent"] = p.bytes_sent;
    json["largest_geometry_share"] = p.largest_geometry;
  }
  return json;
}

Json model_json(const ModesRun& run) {
  if (!run.model) return run.model_failure.empty() ? Json() : Json{{"failure", run.model_failure}};
  const Model& model = *run.model;
  const auto rays = [](const SampledRays& r) -> Json {
    return {{"kind", r.kind}, {"sampled", r.sampled}, {"measured", r.measured}};
  };
  const auto check = [](const Check& c) -> Json {
    return {{"scheme", c.scheme},       {"queues", c.queues},     {"what", c.what},
            {"predicted", c.predicted}, {"measured", c.measured}, {"error", c.error()}};
  };
  return {{"simulation", true},
          {"rays_per_sample", model.rays_per_sample},
          {"tile", {model.tile_width, model.tile_height}},
          {"tiles_over_sequential", model.tiles_over_sequential},
          {"odprt_overhead", model.odprt_overhead},
          {"odprt_overhead_measured", model.overhead_measured},
          {"rays", json_list(model.rays, rays)},
          {"checks", json_list(checks_of(run), check)},
          {"predictions", json_list(model.predictions, [](const Prediction& p) { return json_of(p); })}};
}

Json json_of(const ModesRun& run) {
  return {{"scene", run.scene},
          {"primitives", run.n_primitives},
          {"cores", run.machine.cores},
          {"device", run.machine.device},
          {"vectors", run.machine.vectors},
          {"scene_bytes", run.scene_bytes},
          {"rows", json_list(run.rows, [&](const ModesRow& row) { return json_of(run, row); })},
          {"model", model_json(run)}};
}

std::vector<int> queues_of(std::span<const ModesRun> runs) {
  std::set<int> queues;
  for (const ModesRun& run : runs)
    for (const ModesRow& row : run.rows) queues.insert(row.queues);
  return {queues.begin(), queues.end()};
}

}  // namespace

std::vector<Check> checks_of(const ModesRun& run) {
  std::vector<Check> checks;
  if (!run.model) return checks;
  for (const Prediction& p : run.model->predictions) {
    const ModesRow* const row = run.find(p.scheme, p.queues);
    if (row == nullptr) continue;
    if (row->queues <= run.machine.cores)
      checks.push_back({p.scheme, "seconds", p.queues, p.seconds, row->seconds.median});
    if (p.rays_sent > 0 && row->rays_exchanged.value_or(0) > 0)
      checks.push_back({p.scheme, "rays sent", p.queues, p.rays_sent, *row->rays_exchanged});
  }
  return checks;
}

std::string table_of(const ModesRun& run, const ModesOptions& options) {
  std::string out = fmt::format(
      "{}: {} primitives, {:.1f} MB, {}\n  {:>6}  {:<21}{:>9}{:>9}{:>9}{:>10}{:>8}{:>9}{:>9}{:>9}{:>9}\n",
      short_name(run.scene), run.n_primitives, millions(run.scene_bytes), counted(run.machine.cores, "core"),
      "queues", "", "s", "least", "most", "speed-up", "idle %", "M rays", "MB", "geom. %", "work MB");
  bool shared = false;
  for (const ModesRow& row : run.rows) {
    if (row.failure.empty()) out += line_of(run, row);
    shared |= row.failure.empty() && row.shares_cores();
  }
  if (shared) out += "  * several queues share a core: they are no faster for it\n";
  out += failures_of(run);
  for (const ModesRow& row : run.rows)
    if (row.differing_pixels > 0)
      out += fmt::format("  {} on {}: {} pixels are not the bits of the first picture\n", row.scheme,
                         row.queues, row.differing_pixels);
  if (run.model) out += model_table(run, options.model_options);
  if (!run.model_failure.empty()) out += fmt::format("  no model: {}\n", run.model_failure);
  return out;
}

std::string summary_of(std::span<const ModesRun> runs) {
  std::string out = fmt::format(
      "PDPRT's bag against ODPRT, geometric means over the scenes (the thesis found PDPRT {:g} to {:g}% "
      "faster)\n",
      100 * kThesisLeast, 100 * kThesisMost);
  for (const int queues : queues_of(runs)) {
    std::string line;
    for (const std::string& balance : kBalances)
      if (const auto ratio = odprt_over_pdprt(runs, balance, queues))
        line += fmt::format("{} {}: PDPRT {:.0f}% {}", line.empty() ? "" : ";", balance,
                            100 * std::abs(*ratio - 1), *ratio >= 1 ? "faster" : "slower");
    if (!line.empty()) out += fmt::format("  {:>3} queue{} {}\n", queues, queues == 1 ? ": " : "s:", line);
  }
  return out;
}

Json json_of(std::span<const ModesRun> runs, const ModesOptions& options) {
  const ModelOptions& m = options.model_options;
  Json json = {{"command", "bench modes"},
               {"size", {options.width, options.height}},
               {"depth", options.depth},
               {"repeat", options.repeat},
               {"queues", options.queues},
               {"differing_pixels", count_differing_pixels(runs)},
               {"thesis_pdprt_faster", {kThesisLeast, kThesisMost}},
               {"odprt_over_pdprt", Json::array()},
               {"network",
                {{"gigabytes_per_second", m.gigabytes_per_second},
                 {"latency_us", m.latency_us},
                 {"service_us", m.service_us},
                 {"bytes_per_ray", m.bytes_per_ray},
                 {"subtrees_per_queue", m.subtrees_per_queue}}},
               {"runs", Json::array()}};
  for (const int queues : queues_of(runs))
    for (const std::string& balance : kBalances)
      if (const auto ratio = odprt_over_pdprt(runs, balance, queues))
        json["odprt_over_pdprt"].push_back({{"balance", balance}, {"queues", queues}, {"ratio", *ratio}});
  for (const ModesRun& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

}  // namespace kdray::bench
