#include <fmt/format.h>

#include "bench/embree/embree.h"
#include "bench/rays/bench.h"

namespace kdray::bench {

namespace {

std::string heading(const RaysRun& run) {
  const std::string instances = run.n_instances > 0 ? fmt::format(", {} instances", run.n_instances) : "";
  return fmt::format("{}: {}{}, {}", std::filesystem::path(run.scene).filename().string(),
                     in_words(run.n_primitives), instances, counted(run.machine.cores, "core"));
}

// How many times as fast as `other`; nothing when one is missing.
std::optional<double> ratio(const Outcome* one, const Outcome* other) {
  if (one == nullptr || other == nullptr) return std::nullopt;
  return other->seconds.median / one->seconds.median;
}

struct RayRatios {
  const Outcome *best_kdray, *automatic, *fast, *robust;
  explicit RayRatios(std::span<const Outcome> o)
      : best_kdray(best_of(o, Family::kdray)),
        automatic(find(o, Family::kdray, "auto")),
        fast(best_of(o, Family::embree_fast)),
        robust(best_of(o, Family::embree_robust)) {}
};

std::string rates_line(const ClassResult& c) {
  std::string out = fmt::format("  {:<10}{:>9}", c.name, c.n_rays);
  for (const Outcome& o : c.outcomes) out += cell(mrays_per_s(c.n_rays, o.seconds).median, 9, 2);
  return out + "\n";
}

std::string rates(const RaysRun& run) {
  std::string families = fmt::format("  {:<19}", "Mrays/s"), modes = fmt::format("  {:<10}{:>9}", "", "rays");
  for (const ClassResult& c : run.classes) {
    if (c.outcomes.empty()) continue;
    const Outcome* before = nullptr;
    for (const Outcome& o : c.outcomes) {
      const bool first = before == nullptr || before->family != o.family;
      const std::string family = first ? name_of(o.family) : "";
      families += fmt::format("  {:<7}", family.substr(family.find(' ') + 1));
      modes += fmt::format("{:>9}", o.mode);
      before = &o;
    }
    break;
  }
  std::string out = families + "\n" + modes + "\n";
  for (const ClassResult& c : run.classes) out += rates_line(c);
  return out;
}

std::string spread_in_words(const Outcome* o, std::size_t n_rays) {
  if (o == nullptr) return fmt::format("{:>26}", "-");
  const Spread s = mrays_per_s(n_rays, o->seconds);
  const std::string name =
      o->family == Family::kdray || o->variant.empty() ? o->mode : o->mode + " " + o->variant.substr(0, 3);
  return fmt::format("{:>12}{:>6.1f}-{:<7.1f}", name, s.min, s.max);
}

std::string ratios(const RaysRun& run) {
  std::string out =
      fmt::format("  {:<10}{:>26}{:>26}{:>26}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "best, min-max", "kdray       ",
                  "Embree fast      ", "Embree robust     ", "k/fast", "k/rob", "a/fast", "a/rob", "a/fixed");
  for (const ClassResult& c : run.classes) {
    if (c.outcomes.empty()) {
      out += fmt::format("  {:<10} no rays of this class\n", c.name);
      continue;
    }
    const RayRatios r(c.outcomes);
    out += fmt::format("  {:<10}{}{}{}{}{}{}{}{}\n", c.name, spread_in_words(r.best_kdray, c.n_rays),
                       spread_in_words(r.fast, c.n_rays), spread_in_words(r.robust, c.n_rays),
                       cell(ratio(r.best_kdray, r.fast), 9, 2), cell(ratio(r.best_kdray, r.robust), 9, 2),
                       cell(ratio(r.automatic, r.fast), 9, 2), cell(ratio(r.automatic, r.robust), 9, 2),
                       cell(ratio(r.automatic, best_fixed(c.outcomes)), 9, 2));
  }
  return out;
}

std::string disagreements(const RaysRun& run) {
  std::string out;
  for (const ClassResult& c : run.classes)
    for (const Outcome& o : c.outcomes) {
      if (o.n_not_identical > 0)
        out += fmt::format("  {}: {} of {} hits of kdray {} are not identical to binary's\n", c.name,
                           o.n_not_identical, c.n_rays, o.mode);
      if (o.family != Family::kdray && o.differing_share > 1e-4)
        out += fmt::format("  {}: {} {} sees {:.3f}% of the rays otherwise\n", c.name, name_of(o.family),
                           o.mode, 100 * o.differing_share);
    }
  return out;
}

Json json_of(const ClassResult& c) {
  const auto contestant = [&](const Outcome& o) {
    Json json = {{"family", name_of(o.family)}, {"mode", o.mode}};
    json.update(json_of(o, c.n_rays));
    return json;
  };
  const RayRatios r(c.outcomes);
  const auto times = [](const Outcome* one, const Outcome* other) { return json_if(ratio(one, other)); };
  return {{"name", c.name},
          {"any_hit", c.any_hit},
          {"rays", c.n_rays},
          {"hits", c.n_hits},
          {"contestants", json_list(c.outcomes, contestant)},
          {"ratios",
           {{"best_to_fast", times(r.best_kdray, r.fast)},
            {"best_to_robust", times(r.best_kdray, r.robust)},
            {"auto_to_fast", times(r.automatic, r.fast)},
            {"auto_to_robust", times(r.automatic, r.robust)},
            {"auto_to_best_fixed", times(r.automatic, best_fixed(c.outcomes))}}}};
}

Json json_of(const RaysRun& run) {
  return {{"scene", run.scene},
          {"primitives", json_of(run.n_primitives)},
          {"instances", run.n_instances},
          {"cores", run.machine.cores},
          {"device", run.machine.device},
          {"vectors", run.machine.vectors},
          {"classes", json_list(run.classes, [](const ClassResult& c) { return json_of(c); })}};
}

}  // namespace

std::string table_of(const RaysRun& run) {
  return heading(run) + "\n" + rates(run) + ratios(run) + disagreements(run);
}

Json json_of(std::span<const RaysRun> runs, const RaysOptions& options) {
  return {{"command", "bench rays"},
          {"embree", embree_json(options.embree)},
          {"rays", options.rays},
          {"repeat", options.repeat},
          {"not_identical", count_not_identical(runs)},
          {"runs", json_list(runs, [](const RaysRun& run) { return json_of(run); })}};
}

}  // namespace kdray::bench
