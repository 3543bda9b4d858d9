#include "bench/race/race.h"

#include <algorithm>
#include <array>

#include "api/record.h"
#include "base/error.h"
#include "bench/race/compare.h"

namespace kdray::bench {

namespace {

constexpr std::array<std::string_view, 5> kTraversals = {"binary", "wide", "packet", "batch", "auto"};
constexpr int kWarmUps = 2;  // at the most: no more than rounds

struct Runner {
  const Variant* variant = nullptr;
  std::vector<double> seconds;
};

void hold_against(std::span<const Hit> reference, const std::vector<Hit>& hits, Outcome& outcome) {
  if (outcome.family == Family::kdray)
    outcome.n_not_identical = std::max(outcome.n_not_identical, count_not_identical(reference, hits));
}

std::span<const Hit> reference_of(const Contestant& contestant, std::span<const Hit> of_race) {
  return contestant.reference.empty() ? of_race : contestant.reference;
}

Runner warm_up(const RayClass& rays, std::span<const Hit> reference, const Contestant& contestant, int runs,
               Outcome& outcome) {
  Runner runner;
  double least = 0;
  for (const Variant& variant : contestant.variants)
    for (int i = 0; i < runs; ++i) {
      const Traced traced = variant.trace(rays);
      hold_against(reference, traced.hits, outcome);
      if (runner.variant != nullptr && traced.seconds >= least) continue;
      runner.variant = &variant;
      least = traced.seconds;
      outcome.differing_share = differing_share(reference, traced.hits);
    }
  outcome.variant = runner.variant->name;
  return runner;
}

template <class Accept>
const Outcome* fastest(std::span<const Outcome> outcomes, Accept&& accept) {
  const Outcome* best = nullptr;
  for (const Outcome& o : outcomes)
    if (accept(o) && (best == nullptr || o.seconds.median < best->seconds.median)) best = &o;
  return best;
}

}  // namespace

const char* name_of(Family family) {
  return family == Family::kdray ? "kdray" : family == Family::embree_fast ? "Embree fast" : "Embree robust";
}

std::span<const std::string_view> traversal_names() {
  return kTraversals;
}

Traversal traversal_of(std::string_view name) {
  for (const Traversal t :
       {Traversal::binary, Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic})
    if (api::name_of(t) == name) return t;
  throw Error(ErrorCode::usage, "there is no traversal '" + std::string(name) + "'");
}

Contestant kdray_contestant(const std::shared_ptr<Renderer>& renderer, const std::string& traversal) {
  const auto trace = [renderer, t = traversal_of(traversal)](const RayClass& c) {
    std::vector<Hit> hits = renderer->trace(c.rays, c.any_hit, 1, t);
    return Traced{renderer->statistics().seconds.trace, std::move(hits)};
  };
  return {Family::kdray, traversal, {{"", trace}}};
}

Json json_of(const Outcome& o, std::size_t n_rays) {
  Json json = {{"flag", o.variant},
               {"seconds", json_of(o.seconds)},
               {"mrays_per_s", json_of(mrays_per_s(n_rays, o.seconds))},
               {"differing_share", o.differing_share}};
  if (o.family == Family::kdray) json["not_identical"] = o.n_not_identical;
  return json;
}

std::vector<Outcome> race(const RayClass& rays, std::span<const Hit> reference,
                          const std::vector<Contestant>& contestants, int rounds) {
  std::vector<Outcome> outcomes;
  std::vector<Runner> runners;
  for (const Contestant& c : contestants) {
    outcomes.push_back({.family = c.family, .mode = c.mode, .variant = {}, .seconds = {}});
    runners.push_back(
        warm_up(rays, reference_of(c, reference), c, std::min(rounds, kWarmUps), outcomes.back()));
  }
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < runners.size(); ++i) {
      const Traced traced = runners[i].variant->trace(rays);
      hold_against(reference_of(contestants[i], reference), traced.hits, outcomes[i]);
      runners[i].seconds.push_back(traced.seconds);
    }
  for (std::size_t i = 0; i < runners.size(); ++i) outcomes[i].seconds = spread_of(runners[i].seconds);
  return outcomes;
}

const Outcome* best_of(std::span<const Outcome> outcomes, Family family) {
  return fastest(outcomes, [&](const Outcome& o) { return o.family == family; });
}

const Outcome* best_fixed(std::span<const Outcome> outcomes) {
  return fastest(outcomes, [](const Outcome& o) { return o.family == Family::kdray && o.mode != "auto"; });
}

const Outcome* find(std::span<const Outcome> outcomes, Family family, std::string_view mode) {
  return fastest(outcomes, [&](const Outcome& o) { return o.family == family && o.mode == mode; });
}

}  // namespace kdray::bench
