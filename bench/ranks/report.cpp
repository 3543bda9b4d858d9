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
          {"bytes", c.bytes}};
}

}  // namespace

std::string table_of(const RanksRun& run, const RanksOptions& options) {
  std::string out = fmt::format("{}: {} primitives, {} cores, {}x{}, {} sample{}\n", short_name(run.scene),
                                run.n_primitives, run.cores, options.asked.width, options.asked.height,
                                options.asked.samples, options.asked.samples == 1 ? "" : "s");
  out += costs_line(run);
  out += fmt::format("  {:>6}{:>10}{:>11}{:>11}{:>9}{:>9}{:>9}{:>9}{:>9} |{:>10}{:>10}{:>9}{:>9}\n", "ranks",
                     "delay ms", "predicted", "measured", "least", "most", "error", "from", "to", "messages",
                     "measured", "MB", "measured");
  for (const RanksCheck& c : run.checks)
    out += fmt::format(
        "  {:>6}{:>10.1f}{:>11.4f}{:>11.4f}{:>9.4f}{:>9.4f}{:>8.1f}%{:>8.1f}%{:>8.1f}% |{:>10.0f}{:>10.0f}"
        "{:>9.2f}{:>9.2f}\n",
        c.ranks, 1e3 * c.delay, c.predicted.median, c.measured.median, c.measured.min, c.measured.max,
        100 * c.error(), 100 * (c.ratio.min - 1), 100 * (c.ratio.max - 1), c.messages_predicted, c.messages,
        1e-6 * c.bytes_predicted, 1e-6 * c.bytes);
  out += fmt::format("  a core to each rank, simulated; the largest error above is {:.1f}%\n  {:>6}",
                     100 * run.largest_error(), "ranks");
  for (const AssumedLink& link : options.links) out += fmt::format("{:>22}", link.name);
  out += "\n";
  for (const int ranks : options.predicted) {
    out += fmt::format("  {:>6}", ranks);
    for (const AssumedLink& link : options.links)
      for (const RanksPrediction& p : run.predictions)
        if (p.link == link.name && p.ranks == ranks)
          out += fmt::format("{:>12.4f} s{:>7.1f}%", p.seconds, 100 * p.efficiency);
    out += "\n";
  }
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
                   {"largest_error", run.largest_error()},
                   {"checks", Json::array()},
                   {"predictions", Json::array()}};
    for (const RanksCheck& c : run.checks) of_run["checks"].push_back(json_of(c));
    for (const RanksPrediction& p : run.predictions)
      of_run["predictions"].push_back({{"link", p.link},
                                       {"ranks", p.ranks},
                                       {"seconds", p.seconds},
                                       {"efficiency", p.efficiency},
                                       {"messages", p.messages},
                                       {"simulation_seconds", p.simulation_seconds}});
    json["runs"].push_back(std::move(of_run));
  }
  return json;
}

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
    XyPanel panel{short_name(run.scene), {"ranks", true}, {"seconds", true}, {}};
    for (const AssumedLink& link : options.links) {
      auto& points = panel.points.emplace_back();
      for (const RanksPrediction& p : run.predictions)
        if (p.link == link.name) points.push_back({static_cast<double>(p.ranks), p.seconds});
    }
    panel.points.resize(panel.points.size() + 2);
    auto &real = *(panel.points.end() - 2), &predicted = panel.points.back();
    for (const RanksCheck& c : run.checks) {
      if (c.delay > 0) continue;
      real.push_back({static_cast<double>(c.ranks), c.measured.median});
      predicted.push_back({static_cast<double>(c.ranks), c.predicted.median});
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

}  // namespace kdray::bench
