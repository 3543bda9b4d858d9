#include "bench/modes/model.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "bench/measure/report.h"
#include "bench/modes/events.h"
#include "bench/modes/lives.h"
#include "bench/modes/paths.h"
#include "bench/modes/tiles.h"
#include "bench/modes/traffic.h"
#include "engine/odprt/assign.h"
#include "engine/odprt/division.h"

namespace kdray::bench {

namespace {

constexpr int kTile = 8;  // pixels of the measured tiles' sides
// These are the values of host/engine/odprt.
constexpr std::size_t kLeastSubtrees = 64;
constexpr std::array kKinds = {"primary", "shadow", "reflected", "refracted"};  // by LifeKind

// Of the scene's geometry, what the queue with most of it holds.
double largest_share(const odprt::Cut& cut, const std::vector<std::uint32_t>& queue_of,
                     std::uint32_t n_queues) {
  std::vector<double> sums(n_queues);
  double everywhere = 0, all = 0;
  for (std::size_t i = 0; i < queue_of.size(); ++i) {
    const auto bytes = static_cast<double>(cut.subtrees[i].bytes);
    (queue_of[i] == odprt::kEveryPart ? everywhere : sums[queue_of[i]]) += bytes;
    all += bytes;
  }
  return (everywhere + *std::max_element(sums.begin(), sums.end())) / std::max(all, 1.0);
}

// What every queue holds costs a ray something wherever it is.
static_assert(odprt::kEveryPart == kDirectory);

class Prophet {
 public:
  Prophet(const ModelInput& input, Renderer& renderer, const RenderOptions& frame,
          const ModelOptions& options)
      : input_(input), renderer_(renderer), frame_(frame), options_(options) {}

  Model run() {
    measure_tiles();
    predict_pdprt();
    predict_odprt();
    std::stable_sort(model_.predictions.begin(), model_.predictions.end(),
                     [](const Prediction& a, const Prediction& b) { return a.queues < b.queues; });
    return std::move(model_);
  }

 private:
  // A frame in small tiles, each with its time.
  void measure_tiles() {
    frame_.mode = Mode::pdprt, frame_.division = Division::bag;
    frame_.timeline = true;
    frame_.tile_width = frame_.tile_height = kTile;
    renderer_.render(frame_);
    statistics_ = renderer_.statistics();
    const Statistics::Division& division = statistics_.mode.division.value();
    const double all = sum(division.pdprt.value().tile_seconds);
    if (!(all > 0)) return;
    tiles_ = division.pdprt->tile_seconds;
    model_.tile_width = static_cast<int>(division.tile_width);
    model_.tile_height = static_cast<int>(division.tile_height);
    model_.tiles_over_sequential = all / input_.sequential_seconds;
    for (double& seconds : tiles_) seconds *= input_.sequential_seconds / all;
  }

  void predict_pdprt() {
    if (tiles_.empty()) return;
    const BagLink link{options_.latency_us * 1e-6, options_.service_us * 1e-6};
    const std::vector<std::vector<double>> sizes = tile_sizes(tiles_);
    for (const int queues : input_.queues) {
      const auto n = static_cast<std::uint32_t>(queues);
      add_best("pdprt contiguous", queues, sizes,
               [&](const auto& tiles) { return contiguous_seconds(tiles, n); });
      add_best("pdprt interleaved", queues, sizes,
               [&](const auto& tiles) { return interleaved_seconds(tiles, n); });
      add_best("pdprt bag", queues, sizes, [&](const auto& tiles) { return bag_seconds(tiles, n, link); });
    }
  }

  // In tiles of the size that takes the least time.
  template <class Simulate>
  void add_best(const char* scheme, int queues, const std::vector<std::vector<double>>& sizes,
                const Simulate& seconds_of) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t n_tiles = 0;
    for (const std::vector<double>& tiles : sizes)
      if (const double seconds = seconds_of(tiles); seconds < least) least = seconds, n_tiles = tiles.size();
    add(scheme, queues, least).tiles = n_tiles;
  }

  Prediction& add(const std::string& scheme, int queues, double seconds) {
    Prediction p;
    p.scheme = scheme, p.queues = queues, p.seconds = seconds;
    p.efficiency = seconds > 0 ? input_.sequential_seconds / (queues * seconds) : 0;
    model_.predictions.push_back(p);
    return model_.predictions.back();
  }

  void predict_odprt() {
    const std::vector<LifeRay> pilot = take_sample(options_.sample / 4), lives = take_sample(options_.sample);
    const auto n_eye_rays = std::count_if(lives.begin(), lives.end(),
                                          [](const LifeRay& life) { return life.parent == kNoParent; });
    model_.rays_per_sample =
        static_cast<double>(frame_.width) * frame_.height / static_cast<double>(n_eye_rays);
    model_.odprt_overhead = input_.odprt_overhead.value_or(1);
    model_.overhead_measured = input_.odprt_overhead.has_value();
    compare_rays(lives);
    calibrate(lives);
    for (const int queues : input_.queues) {
      const odprt::Cut cut = odprt::cut(input_.prepared.flat, input_.prepared.wide,
                                        n_subtrees(static_cast<std::size_t>(queues)));
      std::vector<double> expected;
      for (const odprt::Subtree& subtree : cut.subtrees) expected.push_back(subtree.cost);
      predict_odprt("odprt sah", queues, cut, lives, expected);
      predict_odprt("odprt pilot", queues, cut, lives, measured_costs(cut, pilot));
    }
  }

  // Of each subtree, over the pilot sample.
  std::vector<double> measured_costs(const odprt::Cut& cut, const std::vector<LifeRay>& pilot) const {
    std::vector<std::uint32_t> itself(cut.subtrees.size());
    std::iota(itself.begin(), itself.end(), 0u);
    return costs_of_owners(paths_of(cut, itself, pilot), pilot, itself.size(),
                           rates_.seconds_of_shade / rates_.seconds_of_cost);
  }

  std::size_t n_subtrees(std::size_t queues) const {
    return std::max(kLeastSubtrees, queues * static_cast<std::size_t>(options_.subtrees_per_queue));
  }

  std::vector<LifeRay> take_sample(int n) {
    const double aspect = static_cast<double>(frame_.width) / frame_.height;
    LifeOptions options;
    options.width = std::clamp(static_cast<int>(std::sqrt(n * aspect)), 1, frame_.width);
    options.height = std::clamp(static_cast<int>(std::sqrt(n / aspect)), 1, frame_.height);
    options.depth = frame_.depth;
    options.least_weight = statistics_.frame->spawn_threshold;
    return make_lives(input_.scene, options,
                      [&](std::span<const Ray> rays) { return renderer_.trace(rays); });
  }

  Paths paths_of(const odprt::Cut& cut, const std::vector<std::uint32_t>& owner_of,
                 const std::vector<LifeRay>& lives) const {
    return find_paths(input_.prepared.wide, cut, owner_of, lives, input_.prepared.geometry.space);
  }

  void compare_rays(const std::vector<LifeRay>& lives) {
    const auto measured = rays_by_kind(statistics_);
    for (const char* const kind : kKinds)
      model_.rays.push_back({kind, 0, static_cast<double>(measured.at(kind))});
    for (const LifeRay& life : lives) ++model_.rays[static_cast<std::size_t>(life.kind)].sampled;
    for (SampledRays& rays : model_.rays) rays.sampled *= model_.rays_per_sample;
  }

  // Shares one core's seconds out: what it traced by the walks' costs, which are the same in every cut, the
  // rest by the hits that it shaded.
  void calibrate(const std::vector<LifeRay>& lives) {
    const odprt::Cut cut = odprt::cut(input_.prepared.flat, input_.prepared.wide, 1);
    double cost = 0;
    for (const Visit& v : paths_of(cut, std::vector<std::uint32_t>(cut.subtrees.size()), lives).visits)
      cost += v.cost;
    const Statistics::Seconds& s = statistics_.seconds;
    const double trace = s.trace, all = trace + s.shade + s.admit.value_or(0) + s.add.value_or(0);
    const double share = all > 0 && trace > 0 ? trace / all : 1;
    const double total = input_.sequential_seconds / model_.rays_per_sample;
    rates_.seconds_of_cost = share * total / std::max(cost, 1.0);
    const auto n_shaded = std::count_if(lives.begin(), lives.end(), is_shaded);
    rates_.seconds_of_shade =
        (1 - share) * total / static_cast<double>(std::max<std::ptrdiff_t>(n_shaded, 1));
  }

  void predict_odprt(const std::string& scheme, int queues, const odprt::Cut& cut,
                     const std::vector<LifeRay>& lives, const std::vector<double>& costs) {
    const auto n = static_cast<std::uint32_t>(queues);
    const std::vector<std::uint32_t> queue_of =
        odprt::assign(cut, costs, {.n_parts = n, .spare = odprt::kSpare, .replicated = odprt::kReplicated});
    const Rates rates{rates_.seconds_of_cost * model_.odprt_overhead,
                      rates_.seconds_of_shade * model_.odprt_overhead};
    const Traffic traffic =
        make_traffic(lives, paths_of(cut, queue_of, lives), n, rates, model_.rays_per_sample);
    const Network network{options_.gigabytes_per_second * 1e9, options_.latency_us * 1e-6,
                          options_.bytes_per_ray};
    const Simulated outcome = simulate(traffic, n, network);
    Prediction& p = add(scheme, queues, outcome.seconds);
    p.subtrees = cut.subtrees.size();
    p.balance = outcome.busiest > 0 ? input_.sequential_seconds / (queues * outcome.busiest) : 0;
    p.port_seconds = outcome.busiest_port;
    p.critical_path = outcome.critical_path;
    p.rays_sent = outcome.rays_sent, p.bytes_sent = outcome.rays_sent * options_.bytes_per_ray;
    p.largest_geometry = largest_share(cut, queue_of, n);
  }

  const ModelInput& input_;
  Renderer& renderer_;
  RenderOptions frame_;
  const ModelOptions& options_;
  Statistics statistics_;      // of the frame in small tiles
  std::vector<double> tiles_;  // seconds, along the curve that they come in
  Rates rates_;                // without ODPRT's own overhead
  Model model_;
};

}  // namespace

const Prediction* Model::find(const std::string& scheme, int queues) const {
  for (const Prediction& p : predictions)
    if (p.scheme == scheme && p.queues == queues) return &p;
  return nullptr;
}

Model predict_modes(const ModelInput& input, Renderer& renderer, RenderOptions frame,
                    const ModelOptions& options) {
  return Prophet(input, renderer, frame, options).run();
}

}  // namespace kdray::bench
