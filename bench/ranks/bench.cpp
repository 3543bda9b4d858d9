#include "bench/ranks/bench.h"

#include <algorithm>
#include <optional>
#include <thread>

#include "api/hooks.h"
#include "base/timer.h"
#include "bench/workload/scenes.h"
#include "cluster/transport/ranks.h"

namespace kdray::bench {

namespace {

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
  return {.width = options.width,
          .height = options.height,
          .depth = options.depth,
          .samples = options.samples,
          .mode = mode};
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
    const Statistics::Division& division = renderer_->statistics().mode.division.value();
    double busy = 0;
    for (const Statistics::Queue& queue : division.per_queue) busy += queue.busy_seconds;
    busy_.push_back(busy);
    rays_.push_back(division.odprt ? static_cast<double>(division.odprt->rays_total) : 0);
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
  const Statistics& statistics() const { return alone_.statistics(); }

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
  run.n_primitives = modes.front().statistics().scene.primitives;
  run.machine = machine_of(modes.front().statistics());
  run.machine.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));  // it has one
  for (const auto& [n, seconds] : at_once)
    run.at_once[n] = std::min(1.0, run.modes.front().alone.median / median(seconds));
}

}  // namespace

const PreparedScene& SceneShelf::get(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = scenes_.find(name);
  if (found != scenes_.end()) return found->second;
  return scenes_.emplace(name, PreparedScene(Scene(load_scene(name)), {.binary_form = false})).first->second;
}

std::vector<RanksRun> bench_ranks(Team& team, SceneShelf& shelf, bool over_mpi, const RanksOptions& options,
                                  const Progress<RanksRun>& progress) {
  std::vector<RanksRun> runs;
  for (const std::string& name : options.scenes) {
    if (team.leads()) progress.working(name);
    RanksRun run;
    run.scene = name, run.over_mpi = over_mpi;
    measure(run, team, shelf.get(name), options);
    team.meet();
    if (!team.leads()) continue;
    progress.done(run);
    runs.push_back(std::move(run));
  }
  return runs;
}

std::size_t count_differing_pictures(const std::vector<RanksRun>& runs) {
  return count_over(runs, [](const RanksRun& run) {
    return count_over(run.modes, [](const RanksMode& mode) {
      return count_over(mode.rows, [](const RanksRow& row) { return row.differing_pictures; });
    });
  });
}

}  // namespace kdray::bench
