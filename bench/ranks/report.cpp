#include "bench/ranks/bench.h"

#include <fmt/format.h>

#include <optional>

namespace kdray::bench {

namespace {

// Of what as many cores give that know nothing of each other.
std::optional<double> share_of_cores(const RanksRun& run, const RanksMode& mode, const RanksRow& row) {
  const auto found = run.at_once.find(row.ranks);
  if (found == run.at_once.end()) return std::nullopt;
  return mode.speed_up(row) / (row.ranks * found->second);
}

std::string table_of(const RanksRun& run, const RanksMode& mode) {
  std::string out = fmt::format(
      "  {}: one core {:.4f} s ({:.4f} to {:.4f})\n  "
      "{:>6}{:>10}{:>9}{:>9}{:>9}{:>10}{:>10}{:>9}{:>10}{:>9}{:>9}\n",
      mode.name, mode.alone.median, mode.alone.min, mode.alone.max, "ranks", "delay ms", "s", "least", "most",
      "speed-up", "of cores", "busy s", "messages", "MB", "M rays");
  for (const RanksRow& row : mode.rows) {
    const std::optional<double> share = share_of_cores(run, mode, row);
    out += fmt::format(
        "  {:>6}{:>10.1f}{:>9.4f}{:>9.4f}{:>9.4f}{:>10.2f}{:>10}{:>9.4f}{:>10.0f}{:>9.2f}{:>9.3f}\n",
        row.ranks, 1e3 * row.delay, row.seconds.median, row.seconds.min, row.seconds.max, mode.speed_up(row),
        share ? fmt::format("{:.0f}%", 100 * *share) : "-", row.busy, row.messages, 1e-6 * row.bytes,
        1e-6 * row.rays_sent);
  }
  for (const RanksRow& row : mode.rows)
    if (row.differing_pictures > 0)
      out += fmt::format("  {} ranks: {} pictures are not the bits of one core's\n", row.ranks,
                         row.differing_pictures);
  return out;
}

Json json_of(const RanksRun& run, const RanksMode& mode) {
  const auto of_row = [&](const RanksRow& row) -> Json {
    return {{"ranks", row.ranks},
            {"delay_seconds", row.delay},
            {"seconds", json_of(row.seconds)},
            {"rounds", row.rounds},
            {"speed_up", mode.speed_up(row)},
            {"share_of_cores", json_if(share_of_cores(run, mode, row))},
            {"busy_seconds", row.busy},
            {"messages", row.messages},
            {"bytes", row.bytes},
            {"rays_sent", row.rays_sent},
            {"differing_pictures", row.differing_pictures}};
  };
  return {
      {"mode", mode.name}, {"alone_seconds", json_of(mode.alone)}, {"rows", json_list(mode.rows, of_row)}};
}

Json json_of(const RanksRun& run) {
  const MessageCosts& m = run.messages;
  const auto at_once = [](const auto& one) -> Json { return {{"queues", one.first}, {"speed", one.second}}; };
  return {{"scene", run.scene},
          {"primitives", run.n_primitives},
          {"cores", run.machine.cores},
          {"device", run.machine.device},
          {"vectors", run.machine.vectors},
          {"over", run.over_mpi ? "MPI" : "threads"},
          {"network",
           {{"latency_seconds", m.latency},
            {"bytes_per_second", m.bandwidth},
            {"send_seconds", m.send},
            {"take_seconds", m.take}}},
          {"at_once", json_list(run.at_once, at_once)},
          {"modes", json_list(run.modes, [&](const RanksMode& mode) { return json_of(run, mode); })}};
}

}  // namespace

std::string table_of(const RanksRun& run, const RanksOptions& options) {
  const MessageCosts& m = run.messages;
  std::string out = fmt::format(
      "{}: {} primitives, {} cores, {}x{}, {}\n"
      "  network ({}): {:.1f} us, {:.3g} GB/s; a message occupies {:.2f} us to send, {:.2f} us to take\n",
      short_name(run.scene), run.n_primitives, run.machine.cores, options.width, options.height,
      counted(options.samples, "sample"), run.over_mpi ? "MPI" : "threads", 1e6 * m.latency,
      1e-9 * m.bandwidth, 1e6 * m.send, 1e6 * m.take);
  out += "  at once, each by itself:";
  for (const auto& [n, speed] : run.at_once) out += fmt::format(" {} of speed {:.3f};", n, speed);
  out.back() = '\n';
  for (const RanksMode& mode : run.modes) out += table_of(run, mode);
  return out;
}

Json json_of(const std::vector<RanksRun>& runs, const RanksOptions& options) {
  return {{"command", "bench modes --ranks"},
          {"size", {options.width, options.height}},
          {"depth", options.depth},
          {"samples", options.samples},
          {"repeat", options.repeat},
          {"runs", json_list(runs, [](const RanksRun& run) { return json_of(run); })}};
}

}  // namespace kdray::bench
