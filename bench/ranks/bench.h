// What    `kdray bench modes --ranks`: kdray's own protocol of ranks over a simulated network, with costs and
//         a network that were measured in the same run, held against real runs of few ranks; then the same
//         for ranks that are not there.
// Shape   A scene is measured by a team (real.h); each real run is predicted, and its error kept. Predictions
//         beyond go over stated links, with a core to each rank.
// Units   Seconds; bytes a second.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/ranks/real.h"
#include "bench/ranks/simulate_odprt.h"
#include "bench/ranks/simulate_pdprt.h"

namespace kdray::bench {

// A network that is not there.
struct AssumedLink {
  std::string name;
  double latency = 0, bandwidth = 0;
};

struct RanksOptions {
  std::vector<std::string> scenes = {};  // empty: balls
  RanksAsked asked = {};
  std::vector<int> predicted = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000, 2000, 5000, 10000};
  std::vector<int> odprt_predicted = {1, 2, 4, 8, 16, 32, 64, 128, 256};
  // Frames of so many times as many samples as the measured one's, by so many ranks.
  std::vector<double> heavier = {1, 10, 100, 1000, 10000};
  int heavier_ranks = 1000;
  std::vector<AssumedLink> links = {{"10 GB/s, 10 us", 10e-6, 10e9}, {"1 Gbit/s, 50 us", 50e-6, 125e6}};
};

// Real runs beside their predictions, round by round: each is predicted from what was measured in its own
// round.
struct RanksCheck {
  int ranks = 1;
  double delay = 0;
  Spread predicted, measured;
  Spread ratio;  // of the predictions to what was measured
  double busy_predicted = 0, busy = 0;
  double messages_predicted = 0, messages = 0, bytes_predicted = 0, bytes = 0;
  double rays_predicted = 0, rays = 0;  // from queue to queue, in ODPRT
  double error() const { return ratio.median - 1; }
};

struct RanksPrediction {
  std::string link;
  int ranks = 1;
  double seconds = 0, efficiency = 0;  // of a core's time by itself
  double messages = 0;
  double simulation_seconds = 0;  // that it took
  double work = 0;                // seconds of a core, of all tiles or rays
  double rays_sent = 0;           // from rank to rank, in ODPRT
};

struct RanksRun {
  std::string scene;
  std::size_t n_primitives = 0;
  int cores = 1;
  bool over_mpi = false;
  RanksMeasured measured;
  std::vector<RanksCheck> checks, odprt_checks;
  std::vector<RanksPrediction> predictions, odprt_predictions, heavier;
  std::size_t odprt_rays = 0;  // of the frame

  static double largest_error(const std::vector<RanksCheck>& checks);  // without sign, of several ranks
};

// What the setting of a real run was, as the simulation knows it.
RanksSetting setting_of(const MessageCosts& messages, const std::map<int, AtOnce>& at_once, int ranks,
                        double delay);

// How fast each of so many queues is, by what was measured of some numbers of them: the cores' speed together
// is taken to change evenly between two of these, and not to change beyond.
SharedCores::Speed speed_of(const std::map<int, AtOnce>& at_once);

// All members of the team call it; member 0's results count. `done` and `working` are called there.
class SceneShelf;
std::vector<RanksRun> bench_ranks(Team& team, SceneShelf& shelf, bool over_mpi, const RanksOptions& options,
                                  const std::function<void(const RanksRun&)>& done,
                                  const std::function<void(const std::string&)>& working);

// Scenes that members of one process share.
class SceneShelf {
 public:
  SceneShelf();
  ~SceneShelf();
  struct Held {
    explicit Held(const std::string& name);
    Scene scene;
    PreparedScene prepared;
  };
  const Held& get(const std::string& name);

 private:
  struct Shelved;
  std::unique_ptr<Shelved> shelved_;
};

std::size_t count_differing_pixels(const std::vector<RanksRun>& runs);

}  // namespace kdray::bench
