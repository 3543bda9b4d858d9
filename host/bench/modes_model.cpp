#include "bench/modes_model.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/modes_cut.h"
#include "bench/modes_deal.h"
#include "bench/modes_events.h"
#include "bench/modes_lives.h"
#include "bench/modes_paths.h"
#include "bench/modes_tiles.h"

namespace kdray::bench {

namespace {

using Json = nlohmann::json;

constexpr int kTile = 8;                      // pixels of the measured tiles' sides
constexpr std::uint32_t kTilesPerQueue = 16;  // at least, as long as there are any
constexpr std::array kKinds = {"primary", "shadow", "reflected", "refracted"};  // by LifeKind

// The lives of a sample, and where they go in the finest cut.
struct Sample {
  std::vector<LifeRay> lives;
  Paths paths;
};

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
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
    tiles_.seconds = mode.at("tile_seconds").get<std::vector<double>>();
    const Json tile = mode.value("tile", Json::array({kTile, kTile}));
    const auto width = tile.at(0).get<std::uint32_t>(), height = tile.at(1).get<std::uint32_t>();
    const Json& picture = statistics_.at("frame");
    tiles_.columns = (picture.at("width").get<std::uint32_t>() + width - 1) / width;
    tiles_.rows = (picture.at("height").get<std::uint32_t>() + height - 1) / height;
    const double all = sum(tiles_.seconds);
    if (tiles_.seconds.size() != std::size_t{tiles_.columns} * tiles_.rows || !(all > 0)) {
      tiles_ = {};
      return;
    }
    model_.tile_width = static_cast<int>(width), model_.tile_height = static_cast<int>(height);
    model_.tiles_over_sequential = all / input_.sequential_seconds;
    for (double& seconds : tiles_.seconds) seconds *= input_.sequential_seconds / all;
  }

  void predict_pdprt() {
    if (tiles_.seconds.empty()) return;
    const BagLink link{options_.latency_us * 1e-6, options_.service_us * 1e-6};
    for (const int queues : input_.queues) {
      const auto n = static_cast<std::uint32_t>(queues);
      const TileGrid grid = grid_for(tiles_, n, kTilesPerQueue);
      const auto width = model_.tile_width *
                         static_cast<int>(std::lround(static_cast<double>(tiles_.columns) / grid.columns));
      const auto put = [&](const char* scheme, double seconds) {
        Prediction& p = add(scheme, queues, seconds);
        p.tile_width = width, p.tile_height = width * model_.tile_height / model_.tile_width;
      };
      put("pdprt contiguous", contiguous_seconds(grid.seconds, n));
      put("pdprt interleaved", interleaved_seconds(grid.seconds, n));
      put("pdprt bag", bag_seconds(grid.seconds, n, link));
    }
  }

  Prediction& add(const std::string& scheme, int queues, double seconds) {
    Prediction p;
    p.scheme = scheme, p.queues = queues, p.seconds = seconds;
    p.efficiency = seconds > 0 ? input_.sequential_seconds / (queues * seconds) : 0;
    model_.predictions.push_back(p);
    return model_.predictions.back();
  }

  void predict_odprt() {
    const auto most = static_cast<std::size_t>(*std::max_element(input_.queues.begin(), input_.queues.end()));
    const flatten::WideForm& form = input_.prepared.wide;
    const Cut cut(form, pieces_for(most));
    const Sample pilot = take_sample(cut, options_.sample / 4), sample = take_sample(cut, options_.sample);
    const double eye_rays =
        static_cast<double>(std::count_if(sample.lives.begin(), sample.lives.end(), [](const LifeRay& l) {
          return l.depth == 1 && l.kind == LifeKind::primary;
        }));
    model_.rays_per_sample = static_cast<double>(frame_.width) * frame_.height / std::max(1.0, eye_rays);
    model_.odprt_overhead = input_.odprt_overhead.value_or(1);
    model_.overhead_measured = input_.odprt_overhead.has_value();
    compare_rays(sample);
    calibrate(sample);
    const std::vector<double> pilot_costs = costs_of_pieces(pilot.paths, cut.pieces().size());
    std::vector<double> expected_costs;
    for (const Piece& piece : cut.pieces()) expected_costs.push_back(piece.cost);
    for (const int queues : input_.queues) {
      predict_odprt(cut, sample, expected_costs, "odprt sah", queues);
      predict_odprt(cut, sample, pilot_costs, "odprt pilot", queues);
    }
  }

  std::size_t pieces_for(std::size_t queues) const {
    return queues * static_cast<std::size_t>(options_.pieces_per_queue);
  }

  Sample take_sample(const Cut& cut, int n) {
    const double aspect = static_cast<double>(frame_.width) / frame_.height;
    LifeOptions options;
    options.width = std::clamp(static_cast<int>(std::sqrt(n * aspect)), 1, frame_.width);
    options.height = std::clamp(static_cast<int>(std::sqrt(n / aspect)), 1, frame_.height);
    options.depth = frame_.depth;
    options.least_weight = statistics_.at("frame").value("spawn_threshold", 0.0);
    Sample sample;
    sample.lives =
        make_lives(input_.scene, options, [&](std::span<const Ray> rays) { return renderer_.trace(rays); });
    sample.paths = find_paths(input_.prepared.wide, cut, sample.lives, input_.prepared.geometry.center);
    return sample;
  }

  void compare_rays(const Sample& sample) {
    for (const char* const kind : kKinds)
      model_.rays.push_back({kind, 0, statistics_.at("rays").value(kind, 0.0)});
    for (const LifeRay& life : sample.lives)
      model_.rays[static_cast<std::size_t>(life.kind)].sampled += model_.rays_per_sample;
  }

  // Shares one core's seconds out: what it traced by the walks' costs, the rest by rays.
  void calibrate(const Sample& sample) {
    double cost = 0;
    for (const PieceVisit& v : sample.paths.visits) cost += v.cost;
    const Json& seconds = statistics_.at("seconds");
    const double trace = seconds.value("trace", 0.0);
    double all = trace;
    for (const char* const stage : {"shade", "admit", "add"}) all += seconds.value(stage, 0.0);
    const double share = all > 0 ? trace / all : 1;
    const double total = input_.sequential_seconds / model_.rays_per_sample;
    const auto n_rays = static_cast<double>(sample.lives.size());
    cost_seconds_ = cost > 0 ? share * total / cost : 0;
    ray_seconds_ = n_rays > 0 ? (1 - share) * total / n_rays : 0;
  }

  void predict_odprt(const Cut& cut, const Sample& sample, const std::vector<double>& costs,
                     const std::string& scheme, int queues) {
    const auto n = static_cast<std::uint32_t>(queues);
    const std::vector<std::uint32_t> group = cut.coarser(pieces_for(n));
    std::vector<double> of_group(group.empty() ? 0 : group.back() + 1);
    for (std::size_t i = 0; i < group.size(); ++i) of_group[group[i]] += costs[i];
    const std::vector<std::uint32_t> queue_of_group = deal(of_group, n);
    std::vector<std::uint32_t> queue_of(group.size());
    std::vector<double> bytes(n);
    for (std::size_t i = 0; i < group.size(); ++i) {
      queue_of[i] = queue_of_group[group[i]];
      bytes[queue_of[i]] += static_cast<double>(cut.pieces()[i].bytes);
    }
    const Traffic traffic = traffic_of(sample, queue_of, n);
    const Network network{options_.gigabytes_per_second * 1e9, options_.latency_us * 1e-6,
                          options_.bytes_per_ray};
    const Outcome outcome = simulate(traffic, n, network);
    Prediction& p = add(scheme, queues, outcome.seconds);
    p.pieces = static_cast<int>(of_group.size());
    p.balance = outcome.busiest > 0
                    ? input_.sequential_seconds * model_.odprt_overhead / (queues * outcome.busiest)
                    : 0;
    p.port_seconds = outcome.busiest_port;
    p.critical_path = outcome.critical_path;
    p.rays_sent = outcome.rays_sent, p.bytes_sent = outcome.rays_sent * options_.bytes_per_ray;
    const auto whole = static_cast<double>(input_.prepared.wide.bytes());
    p.largest_geometry = whole > 0 ? *std::max_element(bytes.begin(), bytes.end()) / whole : 0;
    if (queues <= kMatrixMost) p.exchange = exchange_matrix(traffic, n);
  }

  // Every ray's way from queue to queue. One that passes no piece is dealt with where it begins: eye rays are dealt out.
  Traffic traffic_of(const Sample& sample, const std::vector<std::uint32_t>& queue_of,
                     std::uint32_t n_queues) const {
    Traffic traffic;
    traffic.rays_per_journey = model_.rays_per_sample;
    traffic.journeys.resize(sample.lives.size());
    const double factor = model_.rays_per_sample * model_.odprt_overhead;
    for (std::size_t i = 0; i < sample.lives.size(); ++i) {
      const LifeRay& life = sample.lives[i];
      Journey& journey = traffic.journeys[i];
      journey.depth = life.depth;
      for (const PieceVisit& v : sample.paths.of(i)) {
        const std::uint32_t queue = queue_of[v.piece];
        if (journey.hops.empty() || journey.hops.back().queue != queue) journey.hops.push_back({queue, 0});
        journey.hops.back().seconds += factor * cost_seconds_ * v.cost;
      }
      const bool from_eye = life.parent == kNoParent;
      if (journey.hops.empty())
        journey.hops.push_back({from_eye ? static_cast<std::uint32_t>(i) % n_queues
                                         : traffic.journeys[life.parent].hops.back().queue,
                                0});
      journey.hops.back().seconds += factor * ray_seconds_;
      if (from_eye)
        traffic.first.push_back(static_cast<std::uint32_t>(i));
      else
        traffic.journeys[life.parent].next.push_back(static_cast<std::uint32_t>(i));
    }
    return traffic;
  }

  const ModelInput& input_;
  Renderer& renderer_;
  RenderOptions frame_;
  const ModelOptions& options_;
  Json statistics_;  // of the frame in small tiles
  TileGrid tiles_;
  double cost_seconds_ = 0, ray_seconds_ = 0;
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
