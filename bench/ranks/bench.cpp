#include "bench/ranks/bench.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <thread>

#include "base/median.h"
#include "base/timer.h"
#include "generate/built_in.h"

namespace kdray::bench {

namespace {

const std::vector<std::string> kScenes = {"balls"};

// What of a round's simulation is held against what was measured.
struct Predicted {
  double seconds = 0, messages = 0, bytes = 0, busy = 0, rays = 0;
};

// `simulate` predicts a round of this machine: what it was slower than usual, and the ranks' setting.
RanksCheck check_of(const RanksMeasured& measured, const RealRanks& real,
                    const std::function<Predicted(double slower, const RanksSetting&)>& simulate) {
  std::vector<double> seconds, ratios;
  std::vector<Predicted> all;
  for (std::size_t i = 0; i < real.rounds.size(); ++i) {
    const RanksRound& round = measured.rounds[i];
    RanksSetting setting = setting_of(measured.messages, round.at_once, real.ranks, real.delay);
    setting.seed = i + 1;
    all.push_back(simulate(round.alone / measured.alone.median, setting));
    seconds.push_back(all.back().seconds), ratios.push_back(all.back().seconds / real.rounds[i]);
  }
  const auto median_of = [&](double Predicted::*what) {
    std::vector<double> values;
    for (const Predicted& p : all) values.push_back(p.*what);
    return median(values);
  };
  RanksCheck check{real.ranks, real.delay, spread_of(seconds), spread_of(real.rounds), spread_of(ratios)};
  check.busy_predicted = median_of(&Predicted::busy), check.busy = real.busy;
  check.messages_predicted = median_of(&Predicted::messages), check.messages = real.messages;
  check.bytes_predicted = median_of(&Predicted::bytes), check.bytes = real.bytes;
  check.rays_predicted = median_of(&Predicted::rays), check.rays = real.rays_sent;
  return check;
}

RanksCheck check_of_pdprt(const RanksMeasured& measured, const RealRanks& real) {
  return check_of(measured, real, [&](double slower, const RanksSetting& setting) {
    const SimulatedRanks s = simulate_pdprt(measured.frame.times(slower), setting);
    return Predicted{s.seconds, static_cast<double>(s.messages), static_cast<double>(s.bytes), s.busy, 0};
  });
}

// The frame is as slow as the machine by its setting's speed.
RanksCheck check_of_odprt(const RanksMeasured& measured, const RealRanks& real, const LivedFrame& lived,
                          const DividedFrame& frame) {
  return check_of(measured, real, [&](double slower, RanksSetting setting) {
    setting.speed = [speed = setting.speed, slower](std::size_t n) { return speed(n) / slower; };
    const SimulatedOdprt s = simulate_odprt(lived, frame, measured.odprt, setting);
    return Predicted{s.seconds, static_cast<double>(s.messages), static_cast<double>(s.bytes), s.busy,
                     static_cast<double>(s.rays_sent)};
  });
}

RanksSetting setting_over(const RanksMeasured& measured, const AssumedLink& link, int ranks) {
  RanksSetting setting;
  setting.ranks = ranks;
  setting.messages = measured.messages;
  setting.messages.latency = link.latency, setting.messages.bandwidth = link.bandwidth;
  setting.moved_by_looks = false;
  // A rank that has a core for itself is not kept from looking by others of this machine.
  for (const RanksRound& round : measured.rounds)
    if (const auto one = round.at_once.find(1); one != round.at_once.end())
      setting.look = std::min(&round == &measured.rounds.front() ? 1.0 : setting.look, one->second.look);
  return setting;
}

// Of a frame of `heavier` times as many samples; what rank 0 does beside the tiles stays.
RanksPrediction predict(const RanksMeasured& measured, const AssumedLink& link, int ranks,
                        double heavier = 1) {
  const Timer timer;
  ReplayedFrame frame = measured.frame;
  for (auto* const list : {&frame.tile_seconds, &frame.by_entry})
    for (double& seconds : *list) seconds *= heavier;
  frame.guessed_waves *= heavier;
  const SimulatedRanks simulated = simulate_pdprt(frame, setting_over(measured, link, ranks));
  const double work = measured.busy * heavier;
  return {link.name,
          ranks,
          simulated.seconds,
          (work + measured.alone.median - measured.busy) / (ranks * simulated.seconds),
          static_cast<double>(simulated.messages),
          timer.seconds(),
          work,
          0};
}

void predict_odprt(RanksRun& run, const PreparedScene& scene, const Scene& model,
                   const RanksOptions& options) {
  const RanksMeasured& m = run.measured;
  const LivedFrame lived = live(scene, model, options.asked.device, m.odprt_width, m.odprt_height,
                                options.asked.depth, options.asked.tile, m.odprt);
  run.odprt_rays = lived.lives.size();
  std::map<int, std::vector<const RealRanks*>> real;
  for (const RealRanks& r : m.real_odprt) real[r.ranks].push_back(&r);
  for (const int n : options.odprt_predicted) real[n];
  for (const auto& [n, checked] : real) {
    const DividedFrame frame = divide(lived, scene, n);
    for (const RealRanks* const r : checked) run.odprt_checks.push_back(check_of_odprt(m, *r, lived, frame));
    if (std::ranges::find(options.odprt_predicted, n) == options.odprt_predicted.end()) continue;
    for (const AssumedLink& link : options.links) {
      const Timer timer;
      const SimulatedOdprt s = simulate_odprt(lived, frame, m.odprt, setting_over(m, link, n));
      run.odprt_predictions.push_back({link.name, n, s.seconds, m.odprt_alone.median / (n * s.seconds),
                                       static_cast<double>(s.messages), timer.seconds(), m.odprt.busy,
                                       static_cast<double>(s.rays_sent)});
    }
  }
}

}  // namespace

SceneShelf::Held::Held(const std::string& name)
    : scene(generate::load_scene(name)), prepared(scene, {.binary_form = false}) {}

struct SceneShelf::Shelved {
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<Held>> held;
};

SceneShelf::SceneShelf() : shelved_(std::make_unique<Shelved>()) {}
SceneShelf::~SceneShelf() = default;

const SceneShelf::Held& SceneShelf::get(const std::string& name) {
  const std::lock_guard lock(shelved_->mutex);
  auto& held = shelved_->held[name];
  if (!held) held = std::make_unique<Held>(name);
  return *held;
}

// One rank is what the model was fitted to.
double RanksRun::largest_error(const std::vector<RanksCheck>& checks) {
  double most = 0;
  for (const RanksCheck& check : checks)
    if (check.ranks > 1) most = std::max(most, std::abs(check.error()));
  return most;
}

SharedCores::Speed speed_of(const std::map<int, AtOnce>& at_once) {
  std::map<double, double> together = {{0, 0}, {1, 1}};
  for (const auto& [n, measured] : at_once) together[n] = n * measured.speed;
  return [together](std::size_t at_work) {
    const auto n = static_cast<double>(std::max<std::size_t>(at_work, 1));
    const auto above = together.lower_bound(n);
    if (above == together.end()) return together.rbegin()->second / n;
    const auto below = above->first == n ? above : std::prev(above);
    const double part = above == below ? 0 : (n - below->first) / (above->first - below->first);
    return (below->second + part * (above->second - below->second)) / n;
  };
}

RanksSetting setting_of(const MessageCosts& messages, const std::map<int, AtOnce>& at_once, int ranks,
                        double delay) {
  RanksSetting setting;
  setting.ranks = ranks;
  setting.delay = delay;
  setting.messages = messages;
  setting.speed = speed_of(at_once);
  if (const auto found = at_once.find(ranks); found != at_once.end()) setting.look = found->second.look;
  return setting;
}

std::vector<RanksRun> bench_ranks(Team& team, SceneShelf& shelf, bool over_mpi, const RanksOptions& options,
                                  const std::function<void(const RanksRun&)>& done,
                                  const std::function<void(const std::string&)>& working) {
  std::vector<RanksRun> runs;
  for (const std::string& name : options.scenes.empty() ? kScenes : options.scenes) {
    if (team.leads()) working(name);
    RanksRun run;
    run.scene = name;
    const SceneShelf::Held& held = shelf.get(name);
    run.n_primitives = held.scene.primitives();
    run.over_mpi = over_mpi;
    run.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    run.measured = measure_ranks(team, held.prepared, options.asked);
    team.meet();
    if (!team.leads()) continue;
    for (const RealRanks& real : run.measured.real) run.checks.push_back(check_of_pdprt(run.measured, real));
    for (const AssumedLink& link : options.links)
      for (const int ranks : options.predicted) run.predictions.push_back(predict(run.measured, link, ranks));
    for (const AssumedLink& link : options.links)
      for (const double heavier : options.heavier)
        run.heavier.push_back(predict(run.measured, link, options.heavier_ranks, heavier));
    if (options.asked.odprt) predict_odprt(run, held.prepared, held.scene, options);
    done(run);
    runs.push_back(std::move(run));
  }
  return runs;
}

std::size_t count_differing_pixels(const std::vector<RanksRun>& runs) {
  std::size_t n = 0;
  for (const RanksRun& run : runs)
    for (const auto* const real : {&run.measured.real, &run.measured.real_odprt})
      for (const RealRanks& ranks : *real) n += ranks.differing_pixels;
  return n;
}

}  // namespace kdray::bench
