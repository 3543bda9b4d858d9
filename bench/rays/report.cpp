#include <fmt/format.h>

#include <filesystem>

#include "bench/embree/embree.h"
#include "bench/rays/bench.h"

namespace kdray::bench {

namespace {

const char* name_of(Family family) {
  switch (family) {
    case Family::embree_fast:
      return "Embree fast";
    case Family::embree_robust:
      return "Embree robust";
    default:
      return "kdray";
  }
}

// Empty when there was none, or when it was left out.
std::string version_of_embree(const RaysOptions& options) {
  return options.embree ? embree_versions() : "";
}

std::string heading(const RaysRun& run) {
  const std::string instances = run.n_instances > 0 ? fmt::format(", {} instances", run.n_instances) : "";
  return fmt::format("{}: {}{}, {} core{}", std::filesystem::path(run.scene).filename().string(),
                     in_words(run.n_primitives), instances, run.cores, run.cores == 1 ? "" : "s");
}

// How many times as fast as `other`, or 0 when one is missing.
double ratio(const Outcome* one, const Outcome* other) {
  return one == nullptr || other == nullptr ? 0 : other->seconds.median / one->seconds.median;
}

struct RayRatios {
  const Outcome *best_kdray, *automatic, *fast, *robust;
  explicit RayRatios(std::span<const Outcome> o)
      : best_kdray(best_of(o, Family::kdray)),
        automatic(find(o, Family::kdray, "auto")),
        fast(best_of(o, Family::embree_fast)),
        robust(best_of(o, Family::embree_robust)) {}
};

std::string cell(double value) {
  return value > 0 ? fmt::format("{:9.2f}", value) : fmt::format("{:>9}", "-");
}

std::string rates_line(const ClassResult& c) {
  std::string out = fmt::format("  {:<10}{:>9}", c.name, c.n_rays);
  for (const Outcome& o : c.outcomes) out += cell(mrays_per_s(c.n_rays, o.seconds).median);
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
                       cell(ratio(r.best_kdray, r.fast)), cell(ratio(r.best_kdray, r.robust)),
                       cell(ratio(r.automatic, r.fast)), cell(ratio(r.automatic, r.robust)),
                       cell(ratio(r.automatic, best_fixed(c.outcomes))));
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

Json json_of(const Outcome& o, std::size_t n_rays) {
  Json json = {{"family", name_of(o.family)},
               {"mode", o.mode},
               {"flag", o.variant},
               {"seconds", json_of(o.seconds)},
               {"mrays_per_s", json_of(mrays_per_s(n_rays, o.seconds))},
               {"differing_share", o.differing_share}};
  if (o.family == Family::kdray) json["not_identical"] = o.n_not_identical;
  return json;
}

Json json_of(const ClassResult& c) {
  const RayRatios r(c.outcomes);
  Json json = {{"name", c.name},   {"any_hit", c.any_hit},         {"rays", c.n_rays},
               {"hits", c.n_hits}, {"contestants", Json::array()}, {"ratios", Json::object()}};
  for (const Outcome& o : c.outcomes) json["contestants"].push_back(json_of(o, c.n_rays));
  const auto put = [&](const char* name, const Outcome* one, const Outcome* other) {
    json["ratios"][name] = one && other ? Json(ratio(one, other)) : Json();
  };
  put("best_to_fast", r.best_kdray, r.fast);
  put("best_to_robust", r.best_kdray, r.robust);
  put("auto_to_fast", r.automatic, r.fast);
  put("auto_to_robust", r.automatic, r.robust);
  put("auto_to_best_fixed", r.automatic, best_fixed(c.outcomes));
  return json;
}

Json json_of(const RaysRun& run) {
  Json json = {{"scene", run.scene},           {"primitives", json_of(run.n_primitives)},
               {"instances", run.n_instances}, {"cores", run.cores},
               {"device", run.device},         {"vectors", run.vectors},
               {"classes", Json::array()}};
  for (const ClassResult& c : run.classes) json["classes"].push_back(json_of(c));
  return json;
}

}  // namespace

std::string table_of(const RaysRun& run) {
  return heading(run) + "\n" + rates(run) + ratios(run) + disagreements(run);
}

Json json_of(std::span<const RaysRun> runs, const RaysOptions& options) {
  const std::string embree = version_of_embree(options);
  Json json = {{"command", "bench rays"},
               {"embree", embree.empty() ? Json() : Json(embree)},
               {"rays", options.rays},
               {"repeat", options.repeat},
               {"not_identical", count_not_identical(runs)},
               {"runs", Json::array()}};
  for (const RaysRun& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

}  // namespace kdray::bench
