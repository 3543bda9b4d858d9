#include "bench/ranks/lived_frame.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "api/statistics_json.h"
#include "bench/modes/paths.h"
#include "odprt/division.h"
#include "odprt/parts.h"
#include "odprt/replicate.h"
#include "prepare/prepared.h"

namespace kdray::bench {

namespace {

constexpr int kPilotPart = 2;  // a pilot sample has so many times fewer rays across and down
// These are the values of host/odprt.
constexpr std::size_t kSubtreesPerPart = 16, kLeastSubtrees = 64, kMostSubtrees = 512, kFewPerPart = 4;

std::size_t subtrees_for(std::size_t n_parts) {
  return std::clamp(kSubtreesPerPart * n_parts, kLeastSubtrees,
                    std::max(kMostSubtrees, kFewPerPart * n_parts));
}

Paths paths_in(const PreparedScene& scene, const odprt::Cut& cut, const std::vector<std::uint32_t>& owner_of,
               const std::vector<LifeRay>& lives) {
  const prepare::Prepared& prepared = scene.prepared();
  return find_paths(prepared.wide, cut, owner_of, lives, prepared.geometry.space);
}

Rates rates_of(const PreparedScene& scene, const std::vector<LifeRay>& lives, const OdprtCosts& costs) {
  const prepare::Prepared& prepared = scene.prepared();
  const odprt::Cut cut = odprt::cut(prepared.flat, prepared.wide, 1);
  double cost = 0;
  for (const Visit& v : paths_in(scene, cut, std::vector<std::uint32_t>(cut.subtrees.size()), lives).visits)
    cost += v.cost;
  const auto n_shaded = static_cast<double>(std::ranges::count_if(lives, is_shaded));
  return {costs.trace_share * costs.busy / std::max(cost, 1.0),
          (1 - costs.trace_share) * costs.busy / std::max(n_shaded, 1.0)};
}

// As odprt::DividedScene weighs subtrees: by rays that come, what one is expected to cost, and hits.
std::vector<double> weights_of(const PreparedScene& scene, const odprt::Cut& cut,
                               const std::vector<LifeRay>& pilot) {
  constexpr double kHitCost = 20;  // as odprt/render.cpp has it
  std::vector<std::uint32_t> itself(cut.subtrees.size());
  std::iota(itself.begin(), itself.end(), 0u);
  const Paths paths = paths_in(scene, cut, itself, pilot);
  std::vector<double> weights(itself.size());
  for (std::size_t i = 0; i < pilot.size(); ++i) {
    for (const Visit& v : paths.of(i))
      if (v.owner != kDirectory) weights[v.owner] += cut.subtrees[v.owner].visit;
    const auto path = paths.of(i);
    if (is_shaded(pilot[i]) && !path.empty() && path.back().owner != kDirectory)
      weights[path.back().owner] += kHitCost;
  }
  return weights;
}

// As odprt::DividedScene divides: less is held by all where that takes too much.
std::vector<std::uint32_t> owners_of(const PreparedScene& scene, const odprt::Cut& cut,
                                     const std::vector<double>& weights, std::uint32_t n) {
  constexpr double kMostSpare = 0.2;
  const prepare::Prepared& prepared = scene.prepared();
  const double most =
      (1.0 / n + kMostSpare) * static_cast<double>(odprt::geometry_bytes(prepared.flat, prepared.wide));
  odprt::DivideOptions options{.n_parts = n, .spare = odprt::kSpare, .replicated = odprt::kReplicated};
  odprt::Division division = odprt::divide(prepared.flat, prepared.wide, cut, weights, options);
  while (options.replicated > 0 && static_cast<double>(odprt::largest_bytes(division)) > most) {
    options.replicated = std::max(options.replicated - 0.04, 0.0);
    division = odprt::divide(prepared.flat, prepared.wide, cut, weights, options);
  }
  return division.part_of;
}

// Eye rays come first among the lives, line by line.
std::uint32_t tile_of(const LivedFrame& frame, std::size_t eye_ray) {
  const auto width = static_cast<std::size_t>(frame.width), side = static_cast<std::size_t>(frame.tile);
  const std::size_t across = (width + side - 1) / side;
  return static_cast<std::uint32_t>(eye_ray / width / side * across + eye_ray % width / side);
}

// As odprt::share_by_part() does: the queue that most of a tile's rays enter first makes them, and what has
// rays that enter none is anyone's; tiles go all over the picture. Returns who makes each tile.
std::vector<std::uint32_t> deal_out(const LivedFrame& frame, const Paths& paths, std::size_t n_queues,
                                    DividedFrame& divided) {
  const std::size_t n_pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  divided.n_tiles = tile_of(frame, n_pixels - 1) + 1;
  std::vector<std::vector<int>> counts(divided.n_tiles, std::vector<int>(n_queues));
  for (std::size_t i = 0; i < n_pixels; ++i) {
    divided.tile_of_first.push_back(tile_of(frame, i));
    if (const std::uint32_t first = first_owner(paths.of(i)); first != kDirectory)
      ++counts[divided.tile_of_first.back()][first];
  }
  divided.tiles.of_queues.resize(n_queues);
  std::vector<std::uint32_t> makers(divided.n_tiles);
  std::size_t step = static_cast<std::size_t>(0.6180339887 * static_cast<double>(divided.n_tiles)) | 1u;
  while (std::gcd(step, divided.n_tiles) != 1) step += 2;
  for (std::size_t i = 0; i < divided.n_tiles; ++i) {
    const auto tile = static_cast<layout::u32>(i * step % divided.n_tiles);
    const auto most = std::ranges::max_element(counts[tile]);
    if (*most > 0) {
      makers[tile] = static_cast<std::uint32_t>(most - counts[tile].begin());
      divided.tiles.of_queues[makers[tile]].push_back(tile);
    } else {
      makers[tile] = static_cast<std::uint32_t>(divided.tiles.anyones.size() % n_queues);
      divided.tiles.anyones.push_back(tile);
    }
  }
  return makers;
}

// Each life's end is where it adds to its pixel, which is the eye ray's that it comes from.
std::vector<std::size_t> pixels_of_queues(const std::vector<LifeRay>& lives, const Traffic& traffic,
                                          std::size_t n_queues) {
  std::vector<std::uint32_t> pixel(lives.size());
  std::vector<std::vector<bool>> touched(n_queues, std::vector<bool>(traffic.first.size()));
  for (std::uint32_t i = 0; i < lives.size(); ++i) {
    pixel[i] = lives[i].parent == kNoParent ? i : pixel[lives[i].parent];
    touched[traffic.journeys[i].hops.back().queue][pixel[i]] = true;
  }
  std::vector<std::size_t> counts;
  for (const std::vector<bool>& of_queue : touched)
    counts.push_back(static_cast<std::size_t>(std::ranges::count(of_queue, true)));
  return counts;
}

}  // namespace

LivedFrame live(const PreparedScene& scene, const Scene& model, const std::string& device, int width,
                int height, int depth, int tile, const OdprtCosts& costs) {
  Renderer renderer(scene, {.device = device});
  RenderOptions small;
  small.width = small.height = 16, small.depth = depth;
  renderer.render(small);
  const nlohmann::json facts = api::statistics_json(renderer.statistics());
  LifeOptions options;
  options.width = width, options.height = height, options.depth = depth;
  options.least_weight = facts.at("frame").value("spawn_threshold", 0.0);
  const Tracer trace = [&](std::span<const Ray> rays) { return renderer.trace(rays); };
  LivedFrame frame;
  frame.width = width, frame.height = height, frame.depth = depth, frame.tile = tile;
  const scene::Scene& described = model.model();
  frame.n_lights = described.lights.size();
  for (const scene::Material& material : described.materials) {
    frame.reflects |= std::max({material.reflect.x, material.reflect.y, material.reflect.z}) > 0;
    frame.transmits |= std::max({material.transmit.x, material.transmit.y, material.transmit.z}) > 0;
  }
  frame.lives = leave_out(make_lives(described, options, trace), costs.rays);
  options.width = std::max(1, width / kPilotPart), options.height = std::max(1, height / kPilotPart);
  frame.pilot = make_lives(described, options, trace);
  frame.rates = rates_of(scene, frame.lives, costs);
  return frame;
}

std::vector<LifeRay> leave_out(std::vector<LifeRay> lives, const std::array<double, 4>& rays) {
  std::array<double, 4> n{}, n_clear{}, out{}, owed{};
  for (const LifeRay& life : lives) {
    const auto kind = static_cast<std::size_t>(life.kind);
    ++n[kind];
    n_clear[kind] += life.hit ? 0 : 1;
  }
  for (std::size_t kind = 1; kind < n.size(); ++kind)
    if (rays[kind] > 0 && n_clear[kind] > 0)
      out[kind] = std::clamp((n[kind] - rays[kind]) / n_clear[kind], 0.0, 1.0);
  std::vector<std::uint32_t> place(lives.size());
  std::vector<LifeRay> kept;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    LifeRay life = lives[i];
    const auto kind = static_cast<std::size_t>(life.kind);
    if (!life.hit && (owed[kind] += out[kind]) >= 1) {
      owed[kind] -= 1;  // it leads to nothing
      continue;
    }
    if (life.parent != kNoParent) life.parent = place[life.parent];
    place[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(life);
  }
  return kept;
}

void trace_where_made(Journey& journey, bool is_shadow) {
  const std::uint32_t here = journey.hops.front().queue;
  const auto again = std::find_if(journey.hops.begin() + 1, journey.hops.end(),
                                  [&](const Hop& hop) { return hop.queue == here; });
  if (again == journey.hops.end()) return;
  const bool is_last = again + 1 == journey.hops.end();
  if (is_last && !is_shadow) return;  // it comes back to be shaded
  journey.hops.front().seconds += again->seconds;
  // A shadow ray that ends here has found something.
  journey.hops.erase(is_last ? journey.hops.begin() + 1 : again, is_last ? journey.hops.end() : again + 1);
}

DividedFrame divide(const LivedFrame& frame, const PreparedScene& scene, int ranks) {
  const prepare::Prepared& prepared = scene.prepared();
  const auto n = static_cast<std::uint32_t>(ranks);
  const odprt::Cut cut = odprt::cut(prepared.flat, prepared.wide, subtrees_for(n));
  const std::vector<std::uint32_t> owner_of = owners_of(scene, cut, weights_of(scene, cut, frame.pilot), n);
  DividedFrame divided;
  const Paths paths = paths_in(scene, cut, owner_of, frame.lives);
  const std::vector<std::uint32_t> makers_of_tiles = deal_out(frame, paths, n, divided);
  std::vector<std::uint32_t> makers;  // of each eye ray
  for (const std::uint32_t tile : divided.tile_of_first) makers.push_back(makers_of_tiles[tile]);
  divided.traffic = make_traffic(frame.lives, paths, n, frame.rates, 1, makers);
  for (std::size_t i = 0; i < frame.lives.size(); ++i) {
    divided.is_shadow.push_back(frame.lives[i].kind == LifeKind::shadow);
    trace_where_made(divided.traffic.journeys[i], divided.is_shadow.back());
  }
  divided.pixels_of = pixels_of_queues(frame.lives, divided.traffic, n);
  return divided;
}

}  // namespace kdray::bench
