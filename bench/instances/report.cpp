#include "bench/instances/bench.h"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "bench/embree/embree.h"
#include "bench/measure/short_name.h"

namespace kdray::bench {

namespace {

struct FamilyName {
  Family family;
  const char *name, *key;
};

constexpr std::array<FamilyName, 3> kFamilies = {{{Family::kdray, "kdray", "kdray"},
                                                  {Family::embree_fast, "Embree fast", "fast"},
                                                  {Family::embree_robust, "Embree robust", "robust"}}};

const char* name_of(Family family) {
  for (const FamilyName& f : kFamilies)
    if (f.family == family) return f.name;
  return "";
}

std::string version_of_embree(const InstancesOptions& options) {
  return options.embree ? embree_versions() : "";
}

std::string heading(const InstancesRun& run) {
  return fmt::format("{}: {} instances of {} triangles, {} apart, {} core{}", short_name(run.mesh),
                     run.n_instances, run.n_triangles, run.apart, run.cores, run.cores == 1 ? "" : "s");
}

std::string line_of(const InstancesClass& c, const Pair& p) {
  const Spread instances = mrays_per_s(c.n_rays, p.instances.seconds),
               copies = mrays_per_s(c.n_rays, p.copies.seconds);
  return fmt::format("  {:<10}{:<15}{:<9}{:>8.2f} {:>7.2f}-{:<8.2f}{:>8.2f} {:>7.2f}-{:<8.2f}{:>7.2f}\n",
                     c.name, name_of(p.instances.family), p.instances.mode, instances.median, instances.min,
                     instances.max, copies.median, copies.min, copies.max,
                     p.instances.seconds.median / p.copies.seconds.median);
}

std::string summary_of(const InstancesClass& c) {
  std::string out = fmt::format("  {:<10}best with each:", c.name);
  for (const FamilyName& f : kFamilies)
    if (const double times = times_copies(c, f.family); times > 0)
      out += fmt::format(" {} {:.2f}", f.name, times);
  out += fmt::format("; {:.3f}% of kdray's hits differ\n", 100 * c.differing_share);
  for (const Pair& p : c.pairs)
    if (const std::size_t n = p.instances.n_not_identical + p.copies.n_not_identical; n > 0)
      out += fmt::format("  {:<10}{} hits of kdray {} are not identical to the first walk's\n", c.name, n,
                         p.instances.mode);
  return out;
}

Json json_of(const Outcome& o, std::size_t n_rays) {
  Json json = {{"flag", o.variant},
               {"seconds", json_of(o.seconds)},
               {"mrays_per_s", json_of(mrays_per_s(n_rays, o.seconds))},
               {"differing_share", o.differing_share}};
  if (o.family == Family::kdray) json["not_identical"] = o.n_not_identical;
  return json;
}

Json json_of(const InstancesClass& c) {
  Json json = {{"name", c.name},
               {"any_hit", c.any_hit},
               {"rays", c.n_rays},
               {"hits", c.n_hits},
               {"differing_share", c.differing_share},
               {"contestants", Json::array()},
               {"times_copies", Json::object()}};
  for (const Pair& p : c.pairs)
    json["contestants"].push_back({{"family", name_of(p.instances.family)},
                                   {"mode", p.instances.mode},
                                   {"instances", json_of(p.instances, c.n_rays)},
                                   {"copies", json_of(p.copies, c.n_rays)},
                                   {"times_copies", p.instances.seconds.median / p.copies.seconds.median}});
  for (const FamilyName& f : kFamilies) {
    const double times = times_copies(c, f.family);
    json["times_copies"][f.key] = times > 0 ? Json(times) : Json();
  }
  return json;
}

Json json_of(const InstancesRun& run) {
  Json json = {{"mesh", run.mesh},
               {"apart", run.apart},
               {"instances", run.n_instances},
               {"triangles", run.n_triangles},
               {"instances_bytes", run.instances_bytes},
               {"copies_bytes", run.copies_bytes},
               {"cores", run.cores},
               {"device", run.device},
               {"vectors", run.vectors},
               {"classes", Json::array()}};
  for (const InstancesClass& c : run.classes) json["classes"].push_back(json_of(c));
  return json;
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
  const std::string embree = version_of_embree(options);
  Json json = {{"command", "bench instances"}, {"embree", embree.empty() ? Json() : Json(embree)},
               {"across", options.across},     {"rays", options.rays},
               {"repeat", options.repeat},     {"not_identical", count_not_identical(runs)},
               {"runs", Json::array()}};
  for (const InstancesRun& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

}  // namespace kdray::bench
