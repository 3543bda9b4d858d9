#include "bench/ranks/report.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/measure/short_name.h"

namespace kdray::bench {

namespace {

constexpr const char* kColors[] = {"#1f5f91", "#e0703f", "#5b8c3a", "#9a5fb0"};

std::string costs_line(const RanksRun& run) {
  const RanksMeasured& m = run.measured;
  std::string out = fmt::format(
      "  network ({}): {:.1f} us, {:.3g} GB/s; a message occupies {:.2f} us to send, {:.2f} us to take;\n"
      "    8 KiB take {:.1f} looks more, 256 KiB {:.1f}, {:.3g} MB go in a look\n"
      "  alone: {:.4f} s ({:.4f} to {:.4f}), busy {:.4f}; {} tiles; a tile's sums: {:.2f} us to hand over, "
      "{:.2f} us to take back\n",
      run.over_mpi ? "MPI" : "threads", 1e6 * m.messages.latency, 1e-9 * m.messages.bandwidth,
      1e6 * m.messages.send, 1e6 * m.messages.take, m.messages.looks_of_middling, m.messages.looks_of_long,
      1e-6 * m.messages.bytes_of_look, m.alone.median, m.alone.min, m.alone.max, m.busy, m.frame.curve.size(),
      1e6 * m.frame.deliver_seconds, 1e6 * m.frame.take_back_seconds);
  out += "  at once:";
  for (const auto& [n, at_once] : m.at_once)
    out += fmt::format(" {} of speed {:.3f}, looking every {:.2f} ms;", n, at_once.speed, 1e3 * at_once.look);
  out.back() = '\n';
  return out;
}

Json json_of(const RanksMeasured& m) {
  Json json = {{"device", m.device},
               {"alone_seconds", json_of(m.alone)},
               {"busy_seconds", m.busy},
               {"tiles", m.frame.curve.size()},
               {"tile", {m.frame.tile_width, m.frame.tile_height}},
               {"wave_seconds", m.frame.wave_seconds},
               {"prepare_seconds", m.frame.prepare_seconds},
               {"begin_seconds", m.frame.begin_seconds},
               {"end_seconds", m.frame.end_seconds},
               {"deliver_seconds_per_tile", m.frame.deliver_seconds},
               {"take_back_seconds_per_tile", m.frame.take_back_seconds},
               {"latency_seconds", m.messages.latency},
               {"bytes_per_second", m.messages.bandwidth},
               {"send_seconds", m.messages.send},
               {"take_seconds", m.messages.take},
               {"looks_of_8_kib", m.messages.looks_of_middling},
               {"looks_of_256_kib", m.messages.looks_of_long},
               {"bytes_of_look", m.messages.bytes_of_look},
               {"at_once", Json::array()}};
  for (const auto& [n, at_once] : m.at_once)
    json["at_once"].push_back({{"queues", n}, {"speed", at_once.speed}, {"look_seconds", at_once.look}});
  return json;
}

Json json_of(const RanksCheck& c) {
  return {{"ranks", c.ranks},
          {"delay_seconds", c.delay},
          {"predicted", json_of(c.predicted)},
          {"measured", json_of(c.measured)},
          {"ratio", json_of(c.ratio)},
          {"error", c.error()},
          {"busy_predicted", c.busy_predicted},
          {"busy", c.busy},
          {"messages_predicted", c.messages_predicted},
          {"messages", c.messages},
          {"bytes_predicted", c.bytes_predicted},
          {"bytes", c.bytes},
          {"rays_predicted", c.rays_predicted},
          {"rays", c.rays}};
}

Json json_of(const RanksPrediction& p) {
  return {{"link", p.link},         {"ranks", p.ranks},
          {"seconds", p.seconds},   {"efficiency", p.efficiency},
          {"messages", p.messages}, {"simulation_seconds", p.simulation_seconds},
          {"work", p.work},         {"rays_sent", p.rays_sent}};
}

template <class List>
Json list_of(const List& list) {
  Json json = Json::array();
  for (const auto& entry : list) json.push_back(json_of(entry));
  return json;
}

std::string checks_table(const std::vector<RanksCheck>& checks, bool odprt) {
  std::string out = fmt::format("  {:>6}{:>10}{:>11}{:>11}{:>9}{:>9}{:>9}{:>9}{:>9} |{:>10}{:>10}{:>9}{:>9}",
                                "ranks", "delay ms", "predicted", "measured", "least", "most", "error",
                                "from", "to", "messages", "measured", "MB", "measured");
  out += odprt ? fmt::format("{:>9}{:>9}\n", "M rays", "measured") : "\n";
  for (const RanksCheck& c : checks) {
    out += fmt::format(
        "  {:>6}{:>10.1f}{:>11.4f}{:>11.4f}{:>9.4f}{:>9.4f}{:>8.1f}%{:>8.1f}%{:>8.1f}% |{:>10.0f}{:>10.0f}"
        "{:>9.2f}{:>9.2f}",
        c.ranks, 1e3 * c.delay, c.predicted.median, c.measured.median, c.measured.min, c.measured.max,
        100 * c.error(), 100 * (c.ratio.min - 1), 100 * (c.ratio.max - 1), c.messages_predicted, c.messages,
        1e-6 * c.bytes_predicted, 1e-6 * c.bytes);
    out += odprt ? fmt::format("{:>9.3f}{:>9.3f}\n", 1e-6 * c.rays_predicted, 1e-6 * c.rays) : "\n";
  }
  return out;
}

std::string predictions_table(const std::vector<RanksPrediction>& predictions, double error,
                              const RanksOptions& options) {
  std::string out = fmt::format(
      "  a core to each rank, simulated; the largest error of several ranks above is {:.1f}%\n"
      "  {:>6}",
      100 * error, "ranks");
  for (const AssumedLink& link : options.links) out += fmt::format("{:>22}", link.name);
  int line = 0;
  std::vector<RanksPrediction> sorted = predictions;
  std::ranges::stable_sort(sorted, {}, &RanksPrediction::ranks);
  for (const RanksPrediction& p : sorted) {
    if (p.ranks != line) out += fmt::format("\n  {:>6}", line = p.ranks);
    out += fmt::format("{:>12.4f} s{:>7.1f}%", p.seconds, 100 * p.efficiency);
  }
  return out + "\n";
}

}  // namespace

std::string table_of(const RanksRun& run, const RanksOptions& options) {
  std::string out = fmt::format("{}: {} primitives, {} cores, {}x{}, {} sample{}\n", short_name(run.scene),
                                run.n_primitives, run.cores, options.asked.width, options.asked.height,
                                options.asked.samples, options.asked.samples == 1 ? "" : "s");
  out += costs_line(run);
  out += checks_table(run.checks, false);
  out += predictions_table(run.predictions, RanksRun::largest_error(run.checks), options);
  out += fmt::format("  heavier frames by {} ranks: seconds of a core, and the frame's seconds\n",
                     options.heavier_ranks);
  for (const RanksPrediction& p : run.heavier)
    out +=
        fmt::format("  {:>10.1f}{:>12.4f} s{:>7.1f}%  {}\n", p.work, p.seconds, 100 * p.efficiency, p.link);
  if (run.odprt_checks.empty()) return out;
  const RanksMeasured& m = run.measured;
  out += fmt::format(
      "  ODPRT, {}x{}: alone {:.4f} s, busy {:.4f}, {:.0f}% of it walks; a ray by mail costs {:.3f} us "
      "more\n",
      m.odprt_width, m.odprt_height, m.odprt_alone.median, m.odprt.busy, 100 * m.odprt.trace_share,
      1e6 * m.odprt.of_sent_ray);
  out += checks_table(run.odprt_checks, true);
  out += predictions_table(run.odprt_predictions, RanksRun::largest_error(run.odprt_checks), options);
  return out;
}

Json json_of(const std::vector<RanksRun>& runs, const RanksOptions& options) {
  const RanksAsked& asked = options.asked;
  Json json = {{"command", "bench modes --ranks"},
               {"size", {asked.width, asked.height}},
               {"depth", asked.depth},
               {"samples", asked.samples},
               {"repeat", asked.repeat},
               {"links", Json::array()},
               {"runs", Json::array()}};
  for (const AssumedLink& link : options.links)
    json["links"].push_back(
        {{"name", link.name}, {"latency_seconds", link.latency}, {"bytes_per_second", link.bandwidth}});
  for (const RanksRun& run : runs) {
    Json of_run = {{"scene", run.scene},
                   {"primitives", run.n_primitives},
                   {"cores", run.cores},
                   {"over", run.over_mpi ? "MPI" : "threads"},
                   {"measured", json_of(run.measured)},
                   {"largest_error", RanksRun::largest_error(run.checks)},
                   {"checks", list_of(run.checks)},
                   {"predictions", list_of(run.predictions)},
                   {"heavier", list_of(run.heavier)}};
    if (!run.odprt_checks.empty())
      of_run["odprt"] = {{"size", {run.measured.odprt_width, run.measured.odprt_height}},
                         {"alone_seconds", json_of(run.measured.odprt_alone)},
                         {"busy_seconds", run.measured.odprt.busy},
                         {"rays", run.odprt_rays},
                         {"trace_share", run.measured.odprt.trace_share},
                         {"seconds_of_sent_ray", run.measured.odprt.of_sent_ray},
                         {"end_seconds", run.measured.odprt.end_seconds},
                         {"largest_error", RanksRun::largest_error(run.odprt_checks)},
                         {"checks", list_of(run.odprt_checks)},
                         {"predictions", list_of(run.odprt_predictions)}};
    json["runs"].push_back(std::move(of_run));
  }
  return json;
}

namespace {

XyPanel panel_of(const std::string& title, const std::vector<RanksCheck>& checks,
                 const std::vector<RanksPrediction>& predictions, const RanksOptions& options) {
  XyPanel panel{title, {"ranks", true}, {"seconds", true}, {}};
  for (const AssumedLink& link : options.links) {
    auto& points = panel.points.emplace_back();
    for (const RanksPrediction& p : predictions)
      if (p.link == link.name) points.push_back({static_cast<double>(p.ranks), p.seconds});
  }
  std::vector<Point> real, predicted;
  for (const RanksCheck& c : checks) {
    if (c.delay > 0) continue;
    real.push_back({static_cast<double>(c.ranks), c.measured.median});
    predicted.push_back({static_cast<double>(c.ranks), c.predicted.median});
  }
  panel.points.push_back(std::move(real));
  panel.points.push_back(std::move(predicted));
  return panel;
}

}  // namespace

XyPlot plot_of(const std::vector<RanksRun>& runs, const RanksOptions& options) {
  XyPlot plot{"Ranks: a frame's seconds by the protocol over a simulated network",
              fmt::format("{}x{}; lines: a core to each rank; points: real runs, and their predictions",
                          options.asked.width, options.asked.height),
              {},
              true,
              {}};
  for (std::size_t i = 0; i < options.links.size(); ++i)
    plot.series.push_back({options.links[i].name, kColors[i % std::size(kColors)]});
  plot.series.push_back({"real, on this machine", "#333333"});
  plot.series.push_back({"the same, predicted", "#999999"});
  for (const RanksRun& run : runs) {
    plot.panels.push_back(panel_of(short_name(run.scene) + ", PDPRT", run.checks, run.predictions, options));
    if (!run.odprt_checks.empty())
      plot.panels.push_back(
          panel_of(short_name(run.scene) + ", ODPRT", run.odprt_checks, run.odprt_predictions, options));
  }
  return plot;
}

}  // namespace kdray::bench
