// What    `kdray bench modes --ranks`: a frame by one core, and the same frame by ranks of a core each, in
//         PDPRT and in ODPRT, with and without a delay of messages; beside them what the network costs, and
//         how fast as many cores are that know nothing of each other.
// Shape   Interleaved, as in `bench modes`: a round has each of them once, and one before that is not
//         counted. Frames at once tell what the cores of this machine give so many queues; what ranks take
//         beyond that is the protocol's and the network's.
// Units   Seconds; bytes a second.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "bench/measure/progress.h"
#include "bench/measure/report.h"
#include "bench/ranks/team.h"
#include "kdray/kdray.h"

namespace kdray::bench {

// What messages cost on the network that there is.
struct MessageCosts {
  double latency = 0;  // one way
  double bandwidth = 1e12;
  double send = 0, take = 0;  // of a thread's time, for each message
};

// Between the first two members of a team, while nobody else does anything: short and long messages there and
// back, for latency and bandwidth (medians); many short ones in a row, for what sending and taking one
// occupies a rank's thread (the least). All members call it; what member 0 gets is measured.
MessageCosts ping_pong(Team& team);

struct RanksOptions {
  std::vector<std::string> scenes;
  std::vector<int> ranks;
  std::vector<double> delays;
  int width = 1024, height = 1024, depth = 5, samples = 1, repeat = 7;
  std::string device = "auto";
};

// Frames by so many ranks.
struct RanksRow {
  int ranks = 1;
  double delay = 0;
  std::vector<double> rounds = {};
  Spread seconds = {};
  double busy = 0;                 // of all queues together; median
  double messages = 0, bytes = 0;  // of rank 0, both ways, for a frame; medians
  double rays_sent = 0;            // from queue to queue, in ODPRT; median
  std::size_t differing_pictures = 0;
};

struct RanksMode {
  std::string name;  // "pdprt"
  Spread alone = {};
  std::vector<RanksRow> rows = {};

  double speed_up(const RanksRow& row) const { return alone.median / row.seconds.median; }
};

struct RanksRun {
  std::string scene;
  std::size_t n_primitives = 0;
  Machine machine;  // with all of its cores
  bool over_mpi = false;
  MessageCosts messages;
  std::map<int, double> at_once;  // of so many frames by themselves, the speed of each as a part of one alone
  std::vector<RanksMode> modes;
};

// Scenes that members of one process share.
class SceneShelf {
 public:
  const PreparedScene& get(const std::string& name);

 private:
  std::mutex mutex_;
  std::map<std::string, PreparedScene> scenes_;
};

// All members of the team call it; member 0's results count, and it alone tells of them.
std::vector<RanksRun> bench_ranks(Team& team, SceneShelf& shelf, bool over_mpi, const RanksOptions& options,
                                  const Progress<RanksRun>& progress);

std::size_t count_differing_pictures(const std::vector<RanksRun>& runs);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

std::string table_of(const RanksRun& run, const RanksOptions& options);
Json json_of(const std::vector<RanksRun>& runs, const RanksOptions& options);

}  // namespace kdray::bench
