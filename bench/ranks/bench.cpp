#include "bench/ranks/bench.h"

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "api/hooks.h"
#include "api/statistics_json.h"
#include "base/timer.h"
#include "bench/workload/scenes.h"
#include "cluster/transport/ranks.h"

namespace kdray::bench {

namespace {

const std::vector<std::string> kScenes = {"balls"};

// What kdray gives several ranks of one core each (api/scheduler.cpp): one core alone is to be like them.
constexpr Tuning kOfRanks{.slices = 1, .waves = 128};

// OpenCL is opened by one thread at a time.
Renderer open(const PreparedScene& scene, const RanksOptions& o, std::shared_ptr<transport::Ranks> ranks) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  api::Hooks hooks;
  hooks.ranks = std::move(ranks);
  Renderer renderer = api::make_renderer(scene, {.device = o.device, .queues = 1, .compute_units = 1}, hooks);
  renderer.tune(kOfRanks);
  return renderer;
}

RenderOptions frame_of(const RanksOptions& options, Mode mode) {
  RenderOptions o;
  o.width = options.width, o.height = options.height, o.depth = options.depth, o.samples = options.samples;
  o.mode = mode;
  return o;
}

// This member as one of so many ranks, or as nobody.
class Place {
 public:
  Place(Team& team, const PreparedScene& scene, const RanksOptions& options, int n, double delay)
      : row_{.ranks = n, .delay = delay} {
    auto transport = team.group(n, delay);
    if (!transport) return;
    ranks_ = std::make_shared<transport::Ranks>(std::move(transport));
    renderer_.emplace(open(scene, options, ranks_));
  }

  void render(const RenderOptions& options, bool counts, const Picture& reference) {
    if (!renderer_) return;
    const transport::Counters before = ranks_->counters();
    const Picture picture = renderer_->render(options);
    const transport::Counters& after = ranks_->counters();
    if (!ranks_->leads()) return;
    if (picture.rgb != reference.rgb) ++row_.differing_pictures;
    if (!counts) return;
    row_.rounds.push_back(renderer_->statistics().seconds.render);
    const nlohmann::json facts = api::statistics_json(renderer_->statistics());
    const nlohmann::json& mode = facts.at("mode");
    double busy = 0;
    for (const auto& queue : mode.at("per_queue")) busy += queue.at("busy_seconds").get<double>();
    busy_.push_back(busy);
    const auto sent = mode.find("exchange");
    rays_.push_back(sent == mode.end() ? 0 : sent->at("rays_total").get<double>());
    messages_.push_back(static_cast<double>(after.sent + after.received - before.sent - before.received));
    bytes_.push_back(static_cast<double>(after.bytes_sent + after.bytes_received - before.bytes_sent -
                                         before.bytes_received));
  }

  // For member 0.
  RanksRow row() const {
    RanksRow row = row_;
    row.seconds = spread_of(row.rounds);
    row.busy = median(busy_), row.rays_sent = median(rays_);
    row.messages = median(messages_), row.bytes = median(bytes_);
    return row;
  }

 private:
  RanksRow row_;
  std::shared_ptr<transport::Ranks> ranks_;
  std::optional<Renderer> renderer_;
  std::vector<double> messages_, bytes_, busy_, rays_;
};

// One of the two modes: a core alone, and all numbers of ranks.
class Measured {
 public:
  Measured(Team& team, const PreparedScene& scene, const RanksOptions& options, Mode mode)
      : team_(team),
        name_(mode == Mode::pdprt ? "pdprt" : "odprt"),
        frame_(frame_of(options, mode)),
        alone_(open(scene, options, nullptr)) {
    for (const int n : options.ranks)
      for (const double delay : options.delays)
        if (n <= team.size() && (n > 1 || delay == 0)) places_.emplace_back(team, scene, options, n, delay);
  }

  // All members' frames at once, of those that are among the first n; the seconds of each, to member 0.
  std::vector<double> render_at_once(int n) {
    team_.meet();
    if (team_.number() < n) alone_.render(frame_);
    std::vector<double> seconds = team_.gather(team_.number() < n ? alone_.statistics().seconds.render : 0);
    if (!seconds.empty()) seconds.resize(static_cast<std::size_t>(n));
    return seconds;
  }

  void round(bool counts) {
    team_.meet();
    if (team_.leads()) {
      reference_ = alone_.render(frame_);
      if (counts) seconds_.push_back(alone_.statistics().seconds.render);
    }
    for (Place& place : places_) {
      team_.meet();
      place.render(frame_, counts, reference_);
    }
  }

  // For member 0.
  RanksMode result() const {
    RanksMode mode{name_, spread_of(seconds_)};
    for (const Place& place : places_) mode.rows.push_back(place.row());
    return mode;
  }
  std::string device() const { return api::statistics_json(alone_.statistics()).at("device").at("name"); }

 private:
  Team& team_;
  std::string name_;
  RenderOptions frame_;
  Renderer alone_;
  std::vector<Place> places_;
  Picture reference_;
  std::vector<double> seconds_;
};

void measure(RanksRun& run, Team& team, const PreparedScene& scene, const RanksOptions& options) {
  run.messages = ping_pong(team);
  std::vector<Measured> modes;
  for (const Mode mode : {Mode::pdprt, Mode::odprt}) modes.emplace_back(team, scene, options, mode);
  std::map<int, std::vector<double>> at_once;
  for (int round = -1; round < options.repeat; ++round) {
    for (const int n : options.ranks) {
      if (n > team.size()) continue;
      const std::vector<double> seconds = modes.front().render_at_once(n);
      if (team.leads() && round >= 0) at_once[n].push_back(sum(seconds) / n);
    }
    for (Measured& mode : modes) mode.round(round >= 0);
    team.meet();
  }
  if (!team.leads()) return;
  for (const Measured& mode : modes) run.modes.push_back(mode.result());
  run.device = modes.front().device();
  for (const auto& [n, seconds] : at_once)
    run.at_once[n] = std::min(1.0, run.modes.front().alone.median / median(seconds));
}

}  // namespace

SceneShelf::Entry::Entry(const std::string& name)
    : scene(load_scene(name)), prepared(scene, {.binary_form = false}) {}

struct SceneShelf::Shelved {
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<Entry>> entries;
};

SceneShelf::SceneShelf() : shelved_(std::make_unique<Shelved>()) {}
SceneShelf::~SceneShelf() = default;

const SceneShelf::Entry& SceneShelf::get(const std::string& name) {
  const std::lock_guard lock(shelved_->mutex);
  auto& entry = shelved_->entries[name];
  if (!entry) entry = std::make_unique<Entry>(name);
  return *entry;
}

std::vector<RanksRun> bench_ranks(Team& team, SceneShelf& shelf, bool over_mpi, const RanksOptions& options,
                                  const std::function<void(const RanksRun&)>& done,
                                  const std::function<void(const std::string&)>& working) {
  std::vector<RanksRun> runs;
  for (const std::string& name : options.scenes.empty() ? kScenes : options.scenes) {
    if (team.leads()) working(name);
    const SceneShelf::Entry& entry = shelf.get(name);
    RanksRun run;
    run.scene = name, run.n_primitives = entry.scene.primitives(), run.over_mpi = over_mpi;
    run.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    measure(run, team, entry.prepared, options);
    team.meet();
    if (!team.leads()) continue;
    done(run);
    runs.push_back(std::move(run));
  }
  return runs;
}

std::size_t count_differing_pictures(const std::vector<RanksRun>& runs) {
  std::size_t n = 0;
  for (const RanksRun& run : runs)
    for (const RanksMode& mode : run.modes)
      for (const RanksRow& row : mode.rows) n += row.differing_pictures;
  return n;
}

}  // namespace kdray::bench
