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

RanksCheck check_of(const RanksMeasured& measured, const RealRanks& real) {
  std::vector<double> seconds, ratios, messages, bytes, busy;
  for (std::size_t i = 0; i < real.rounds.size(); ++i) {
    const RanksRound& round = measured.rounds[i];
    RanksSetting setting = setting_of(measured.messages, round.at_once, real.ranks, real.delay);
    setting.seed = i + 1;
    const SimulatedRanks simulated =
        simulate_pdprt(measured.frame.times(round.alone / measured.alone.median), setting);
    seconds.push_back(simulated.seconds), ratios.push_back(simulated.seconds / real.rounds[i]);
    messages.push_back(static_cast<double>(simulated.messages));
    bytes.push_back(static_cast<double>(simulated.bytes)), busy.push_back(simulated.busy);
  }
  RanksCheck check{real.ranks, real.delay, spread_of(seconds), spread_of(real.rounds), spread_of(ratios)};
  check.busy_predicted = median(busy), check.busy = real.busy;
  check.messages_predicted = median(messages), check.messages = real.messages;
  check.bytes_predicted = median(bytes), check.bytes = real.bytes;
  return check;
}

RanksPrediction predict(const RanksMeasured& measured, const AssumedLink& link, int ranks) {
  RanksSetting setting;
  setting.ranks = ranks;
  setting.messages = measured.messages;
  setting.messages.latency = link.latency, setting.messages.bandwidth = link.bandwidth;
  setting.moved_by_looks = false;
  if (measured.at_once.count(1)) setting.look = measured.at_once.at(1).look;
  const Timer timer;
  const SimulatedRanks simulated = simulate_pdprt(measured.frame, setting);
  return {link.name,
          ranks,
          simulated.seconds,
          measured.alone.median / (ranks * simulated.seconds),
          static_cast<double>(simulated.messages),
          timer.seconds()};
}

}  // namespace

struct SceneShelf::Shelved {
  struct Held {
    explicit Held(const std::string& name)
        : scene(generate::load_scene(name)), prepared(scene, {.binary_form = false}) {}
    Scene scene;
    PreparedScene prepared;
  };
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<Held>> held;
};

SceneShelf::SceneShelf() : shelved_(std::make_unique<Shelved>()) {}
SceneShelf::~SceneShelf() = default;

const PreparedScene& SceneShelf::get(const std::string& name, std::size_t* n_primitives) {
  const std::lock_guard lock(shelved_->mutex);
  auto& held = shelved_->held[name];
  if (!held) held = std::make_unique<Shelved::Held>(name);
  *n_primitives = held->scene.primitives();
  return held->prepared;
}

double RanksRun::largest_error() const {
  double most = 0;
  for (const RanksCheck& check : checks) most = std::max(most, std::abs(check.error()));
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
    const PreparedScene& scene = shelf.get(name, &run.n_primitives);
    run.over_mpi = over_mpi;
    run.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    run.measured = measure_ranks(team, scene, options.asked);
    team.meet();
    if (!team.leads()) continue;
    for (const RealRanks& real : run.measured.real) run.checks.push_back(check_of(run.measured, real));
    for (const AssumedLink& link : options.links)
      for (const int ranks : options.predicted) run.predictions.push_back(predict(run.measured, link, ranks));
    done(run);
    runs.push_back(std::move(run));
  }
  return runs;
}

std::size_t count_differing_pixels(const std::vector<RanksRun>& runs) {
  std::size_t n = 0;
  for (const RanksRun& run : runs)
    for (const RealRanks& real : run.measured.real) n += real.differing_pixels;
  return n;
}

}  // namespace kdray::bench
