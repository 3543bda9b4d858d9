#include "bench/queries/bench.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/embree/embree.h"

namespace kdray::bench {

namespace {

const SideResult* find(const std::vector<SideResult>& sides, std::string_view name) {
  const auto found =
      std::find_if(sides.begin(), sides.end(), [&](const SideResult& s) { return s.side == name; });
  return found == sides.end() ? nullptr : &*found;
}

// How many times as long the other takes as kdray; nothing where there is no other.
struct Ratio {
  std::optional<double> wall, cpu;
  Ratio(const std::vector<SideResult>& sides, std::string_view other) {
    const SideResult *const kdray = find(sides, "kdray"), *const o = find(sides, other);
    if (kdray == nullptr || o == nullptr) return;
    wall = o->wall.median / kdray->wall.median;
    cpu = o->cpu.median / kdray->cpu.median;
  }
};

std::string side_cells(const SideResult* side) {
  if (side == nullptr) return fmt::format("{:>12}{:>15}{:>8}", "-", "", "");
  return fmt::format("{:>12.1f}{:>15}{:>8}", 1e6 * side->wall.median, side->form, side->n_differing);
}

std::string ratio_cells(const std::vector<SideResult>& sides) {
  const Ratio fast(sides, "fast"), robust(sides, "robust");
  return cell(fast.wall, 8, 2) + cell(robust.wall, 8, 2) + cell(fast.cpu, 9, 2) + cell(robust.cpu, 9, 2);
}

std::string line_of(const CellResult& c) {
  const SideResult* const kdray = find(c.sides, "kdray");
  return fmt::format("  {:<9}{:<9}{:>8}{:>12.1f}{}{}{}{:>12}{}\n", c.question, c.set, c.batch,
                     1e6 * kdray->wall.median, side_cells(find(c.sides, "fast")),
                     side_cells(find(c.sides, "robust")), ratio_cells(c.sides),
                     c.on_device ? cell(1e6 * c.on_device->median, 12, 1) : "",
                     find(c.sides, "double") ? cell(Ratio(c.sides, "double").wall, 8, 2) : "");
}

Json json_of(const SideResult& s) {
  return {{"side", s.side},
          {"form", s.form},
          {"seconds", json_of(s.wall)},
          {"cpu_seconds", json_of(s.cpu)},
          {"differing", s.n_differing}};
}

Json ratios_of(const std::vector<SideResult>& sides) {
  Json json = Json::object();
  for (const char* const other : {"fast", "robust", "double"}) {
    const Ratio ratio(sides, other);
    json[other] = json_if(ratio.wall);
    json[std::string(other) + "_cpu"] = json_if(ratio.cpu);
  }
  return json;
}

Json json_of(const CellResult& c) {
  return {{"question", c.question},
          {"set", c.set},
          {"batch", c.batch},
          {"calls", c.calls},
          {"sides", json_list(c.sides, [](const SideResult& s) { return json_of(s); })},
          {"ratios", ratios_of(c.sides)},
          {"on_device", json_if(c.on_device)}};
}

Json json_of(const QueriesRun& run) {
  return {{"scene", run.scene},
          {"triangles", run.n_triangles},
          {"cores", run.machine.cores},
          {"device", run.machine.device},
          {"vectors", run.machine.vectors},
          {"first_in_process", run.first_in_process},
          {"first_answers", json_list(run.first_answers, [](const SideResult& s) { return json_of(s); })},
          {"first_answer_ratios", ratios_of(run.first_answers)},
          {"cells", json_list(run.cells, [](const CellResult& c) { return json_of(c); })}};
}

}  // namespace

std::string table_of(const QueriesRun& run) {
  std::string out = fmt::format("{}: {} triangles, {} of {}\n", short_name(run.scene), run.n_triangles,
                                counted(run.machine.cores, "core"), run.machine.device);
  out += fmt::format("  from arrays to the first answer, s:");
  for (const SideResult& s : run.first_answers) out += fmt::format(" {} {:.3f}", s.side, s.wall.median);
  out += fmt::format("; the first in this process {:.3f}\n", run.first_in_process);
  out += fmt::format("  {:<26}{:>12}{:>12}{:>15}{:>8}{:>12}{:>15}{:>8}{:>8}{:>8}{:>9}{:>9}{:>12}{:>8}\n",
                     "microseconds for a call", "kdray", "fast", "", "other", "robust", "", "other", "k/fast",
                     "k/rob", "cpu/fast", "cpu/rob", "on device",
                     find(run.first_answers, "double") ? "double" : "");
  for (const CellResult& cell : run.cells) out += line_of(cell);
  return out;
}

Json json_of(std::span<const QueriesRun> runs, const QueriesOptions& options) {
  return {{"command", "bench queries"},
          {"embree", embree_json(options.embree)},
          {"rays", options.rays},
          {"repeat", options.repeat},
          {"runs", json_list(runs, [](const QueriesRun& run) { return json_of(run); })}};
}

}  // namespace kdray::bench
