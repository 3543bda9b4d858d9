#include "bench/modes_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/modes_events.h"
#include "bench/modes_lives.h"
#include "bench/modes_paths.h"
#include "bench/modes_tiles.h"
#include "odprt/deal.h"
#include "odprt/subtrees.h"

namespace kdray::bench {

namespace {

using Json = nlohmann::json;

constexpr int kTile = 8;  // pixels of the measured tiles' sides
// As host/odprt has them.
constexpr std::size_t kLeastSubtrees = 64;
constexpr double kSpareGeometry = 0.15;  // of the scene, that a queue may hold beyond its share
constexpr std::array kKinds = {"primary", "shadow", "reflected", "refracted"};  // by LifeKind

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Of the queue that holds the most.
double largest_sum(const std::vector<std::uint64_t>& values, const std::vector<std::uint32_t>& queue_of,
                   std::uint32_t n_queues) {
  std::vector<double> sums(n_queues);
  for (std::size_t i = 0; i < values.size(); ++i) sums[queue_of[i]] += static_cast<double>(values[i]);
  return *std::max_element(sums.begin(), sums.end());
}

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
    statistics_ = Json::parse(renderer_.statistics());
    const Json& mode = statistics_.at("mode");
    if (!mode.contains("tile_seconds") || !mode.at("tile_seconds").is_array()) return;
    tiles_ = mode.at("tile_seconds").get<std::vector<double>>();
    const double all = sum(tiles_);
    if (!(all > 0)) {
      tiles_.clear();
      return;
    }
    const Json tile = mode.value("tile", Json::array({kTile, kTile}));
    model_.tile_width = tile.at(0), model_.tile_height = tile.at(1);
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
    for (const int queues : input_.queues) {
      const odprt::Cut cut = odprt::cut(input_.prepared.flat, input_.prepared.wide,
                                        n_subtrees(static_cast<std::size_t>(queues)));
      const Paths paths = paths_of(cut, lives);
      calibrate(paths, lives);
      std::vector<double> expected;
      for (const odprt::Subtree& subtree : cut.subtrees) expected.push_back(subtree.cost);
      predict_odprt("odprt sah", queues, cut, lives, paths, expected);
      predict_odprt("odprt pilot", queues, cut, lives, paths,
                    costs_of_subtrees(paths_of(cut, pilot), pilot, cut.subtrees.size(),
                                      shade_seconds_ / cost_seconds_));
    }
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
    options.least_weight = statistics_.at("frame").value("spawn_threshold", 0.0);
    return make_lives(input_.scene, options,
                      [&](std::span<const Ray> rays) { return renderer_.trace(rays); });
  }

  Paths paths_of(const odprt::Cut& cut, const std::vector<LifeRay>& lives) const {
    return find_paths(input_.prepared.wide, cut, lives, input_.prepared.geometry.center);
  }

  void compare_rays(const std::vector<LifeRay>& lives) {
    for (const char* const kind : kKinds)
      model_.rays.push_back({kind, 0, statistics_.at("rays").value(kind, 0.0)});
    for (const LifeRay& life : lives) ++model_.rays[static_cast<std::size_t>(life.kind)].sampled;
    for (SampledRays& rays : model_.rays) rays.sampled *= model_.rays_per_sample;
  }

  // Shares one core's seconds out: what it traced by the walks' costs, the rest by the hits that it shaded.
  void calibrate(const Paths& paths, const std::vector<LifeRay>& lives) {
    double cost = 0;
    for (const SubtreeVisit& v : paths.visits) cost += v.cost;
    const Json& seconds = statistics_.at("seconds");
    const double trace = seconds.value("trace", 0.0);
    double all = trace;
    for (const char* const stage : {"shade", "admit", "add"}) all += seconds.value(stage, 0.0);
    const double share = all > 0 && trace > 0 ? trace / all : 1;
    const double total = input_.sequential_seconds / model_.rays_per_sample;
    cost_seconds_ = share * total / std::max(cost, 1.0);
    const auto n_shaded = std::count_if(lives.begin(), lives.end(), is_shaded);
    shade_seconds_ = (1 - share) * total / static_cast<double>(std::max<std::ptrdiff_t>(n_shaded, 1));
  }

  void predict_odprt(const std::string& scheme, int queues, const odprt::Cut& cut,
                     const std::vector<LifeRay>& lives, const Paths& paths,
                     const std::vector<double>& costs) {
    const auto n = static_cast<std::uint32_t>(queues);
    std::vector<std::uint64_t> bytes;
    for (const odprt::Subtree& subtree : cut.subtrees) bytes.push_back(subtree.bytes);
    const auto whole = static_cast<double>(std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0}));
    const std::vector<std::uint32_t> queue_of =
        odprt::deal(costs, bytes, n, static_cast<std::uint64_t>(whole * (1.0 / queues + kSpareGeometry)));
    const Traffic traffic = traffic_of(lives, paths, queue_of, n);
    const Network network{options_.gigabytes_per_second * 1e9, options_.latency_us * 1e-6,
                          options_.bytes_per_ray};
    const Outcome outcome = simulate(traffic, n, network);
    Prediction& p = add(scheme, queues, outcome.seconds);
    p.subtrees = cut.subtrees.size();
    p.balance = outcome.busiest > 0 ? input_.sequential_seconds / (queues * outcome.busiest) : 0;
    p.port_seconds = outcome.busiest_port;
    p.critical_path = outcome.critical_path;
    p.rays_sent = outcome.rays_sent, p.bytes_sent = outcome.rays_sent * options_.bytes_per_ray;
    p.largest_geometry = largest_sum(bytes, queue_of, n) / std::max(whole, 1.0);
    if (queues <= kMatrixMost) p.exchange = exchange_matrix(traffic, n);
  }

  // Every ray's way from queue to queue. Eye rays are dealt out evenly to begin with; the directory is walked by whoever has
  // the ray, and where it ends it is shaded.
  Traffic traffic_of(const std::vector<LifeRay>& lives, const Paths& paths,
                     const std::vector<std::uint32_t>& queue_of, std::uint32_t n_queues) const {
    Traffic traffic;
    traffic.rays_per_journey = model_.rays_per_sample;
    traffic.journeys.resize(lives.size());
    const double factor = model_.rays_per_sample * model_.odprt_overhead;
    for (std::uint32_t i = 0; i < lives.size(); ++i) {
      const LifeRay& life = lives[i];
      std::vector<Hop>& hops = traffic.journeys[i].hops;
      traffic.journeys[i].depth = life.depth;
      const bool from_eye = life.parent == kNoParent;
      hops.push_back({from_eye ? i % n_queues : traffic.journeys[life.parent].hops.back().queue, 0});
      for (const SubtreeVisit& v : paths.of(i)) {
        const std::uint32_t queue = v.subtree == kDirectory ? hops.back().queue : queue_of[v.subtree];
        if (hops.back().queue != queue) hops.push_back({queue, 0});
        hops.back().seconds += factor * cost_seconds_ * v.cost;
      }
      if (is_shaded(life)) hops.back().seconds += factor * shade_seconds_;
      (from_eye ? traffic.first : traffic.journeys[life.parent].next).push_back(i);
    }
    return traffic;
  }

  const ModelInput& input_;
  Renderer& renderer_;
  RenderOptions frame_;
  const ModelOptions& options_;
  Json statistics_;            // of the frame in small tiles
  std::vector<double> tiles_;  // seconds, along the curve that they come in
  double cost_seconds_ = 0, shade_seconds_ = 0;
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
