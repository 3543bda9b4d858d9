#include "bench/instances/bench.h"

#include <fmt/format.h>

#include "bench/embree/embree.h"

namespace kdray::bench {

namespace {

constexpr Family kFamilies[] = {Family::kdray, Family::embree_fast, Family::embree_robust};

std::string heading(const InstancesRun& run) {
  return fmt::format("{}: {} instances of {} triangles, {} apart, {}", short_name(run.mesh), run.n_instances,
                     run.n_triangles, run.apart, counted(run.machine.cores, "core"));
}

std::string line_of(const InstancesClass& c, const Pair& p) {
  const Spread instances = mrays_per_s(c.n_rays, p.instances.seconds),
               copies = mrays_per_s(c.n_rays, p.copies.seconds);
  return fmt::format("  {:<10}{:<15}{:<9}{:>8.2f} {:>7.2f}-{:<8.2f}{:>8.2f} {:>7.2f}-{:<8.2f}{:>7.2f}\n",
                     c.name, name_of(p.instances.family), p.instances.mode, instances.median, instances.min,
                     instances.max, copies.median, copies.min, copies.max, p.times());
}

std::string summary_of(const InstancesClass& c) {
  std::string out = fmt::format("  {:<10}best with each:", c.name);
  for (const Family f : kFamilies)
    if (const double times = times_copies(c, f); times > 0)
      out += fmt::format(" {} {:.2f}", name_of(f), times);
  out += fmt::format("; {:.3f}% of kdray's hits differ\n", 100 * c.differing_share);
  for (const Pair& p : c.pairs)
    if (const std::size_t n = p.n_not_identical(); n > 0)
      out += fmt::format("  {:<10}{} hits of kdray {} are not identical to the first walk's\n", c.name, n,
                         p.instances.mode);
  return out;
}

Json json_of(const InstancesClass& c) {
  const auto contestant = [&](const Pair& p) -> Json {
    return {{"family", name_of(p.instances.family)},
            {"mode", p.instances.mode},
            {"instances", json_of(p.instances, c.n_rays)},
            {"copies", json_of(p.copies, c.n_rays)},
            {"times_copies", p.times()}};
  };
  const auto times = [&](Family family) {
    const double found = times_copies(c, family);
    return found > 0 ? Json(found) : Json();
  };
  return {{"name", c.name},
          {"any_hit", c.any_hit},
          {"rays", c.n_rays},
          {"hits", c.n_hits},
          {"differing_share", c.differing_share},
          {"contestants", json_list(c.pairs, contestant)},
          {"times_copies",
           {{"kdray", times(Family::kdray)},
            {"fast", times(Family::embree_fast)},
            {"robust", times(Family::embree_robust)}}}};
}

Json json_of(const InstancesRun& run) {
  return {{"mesh", run.mesh},
          {"apart", run.apart},
          {"instances", run.n_instances},
          {"triangles", run.n_triangles},
          {"instances_bytes", run.instances_bytes},
          {"copies_bytes", run.copies_bytes},
          {"cores", run.machine.cores},
          {"device", run.machine.device},
          {"vectors", run.machine.vectors},
          {"classes", json_list(run.classes, [](const InstancesClass& c) { return json_of(c); })}};
}

}  // namespace

std::string table_of(const InstancesRun& run) {
  std::string out = heading(run) + "\n" +
                    fmt::format("  {:<34}{:>8} {:<16}{:>8} {:<16}{:>7}\n", "Mrays/s", "instances", "",
                                "copies", "", "times");
  for (const InstancesClass& c : run.classes) {
    if (c.pairs.empty()) out += fmt::format("  {:<10}no rays of this class\n", c.name);
    for (const Pair& p : c.pairs) out += line_of(c, p);
  }
  for (const InstancesClass& c : run.classes)
    if (!c.pairs.empty()) out += summary_of(c);
  return out;
}

Json json_of(std::span<const InstancesRun> runs, const InstancesOptions& options) {
  return {{"command", "bench instances"},
          {"embree", embree_json(options.embree)},
          {"across", options.across},
          {"rays", options.rays},
          {"repeat", options.repeat},
          {"not_identical", count_not_identical(runs)},
          {"runs", json_list(runs, [](const InstancesRun& run) { return json_of(run); })}};
}

}  // namespace kdray::bench
