// What    `kdray bench modes`: the thesis' comparison. A frame by one core alone, by PDPRT's divisions and by
//         ODPRT's balances, for growing numbers of queues; and what the model predicts for queues that are
//         not there (model.h).
// Shape   Interleaved: a round is a frame of every row's; one before that is not counted. A queue has one
//         core while there are cores; beyond that several queues share one, and the row says so. The rows of
//         a scene each keep a Renderer, so that the rounds of a dynamic balance are the frames of a sequence.
// Errors  A row that fails keeps the message and is not tried again; the others go on. Pixels that are not
//         the bits of the first row's are counted, not thrown.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/progress.h"
#include "bench/measure/report.h"
#include "bench/modes/model.h"
#include "kdray/kdray.h"

namespace kdray::bench {

// How a row divides the frame.
struct Scheme {
  std::string name;  // "pdprt bag"
  Mode mode = Mode::pdprt;
  Division division = Division::bag;
  Balance balance = Balance::pilot;
  bool whole_device = false;  // one queue on all cores
};

// PDPRT's divisions, then ODPRT's balances: what runs on every number of queues.
const std::vector<Scheme>& schemes();

struct ModesOptions {
  std::vector<std::string> scenes = {"balls", "gears", "mount", "rings", "teapot", "tetra", "tree"};
  std::vector<int> queues = {1, 2, 4, 8};
  int width = 1024, height = 1024, depth = 5;
  int repeat = 7;
  std::string device = "auto";
  bool model = true;
  ModelOptions model_options = {};
};

// What a scheme took on a number of queues. What the statistics don't tell is empty.
struct ModesRow {
  std::string scheme;
  int queues = 1;
  int sub_devices = 1;  // fewer than queues: some share a core
  std::string failure;  // why there are no figures
  std::vector<double> rounds = {};
  Spread seconds = {};
  std::optional<Spread> idle_share = {};    // of the queues' time, their mean
  std::optional<double> busy_seconds = {};  // of all queues together; the median round's
  std::optional<double> rays_exchanged = {}, bytes_exchanged = {};
  std::optional<double> geometry_bytes = {}, work_bytes = {};  // of the queue that holds the most
  std::optional<double> geometry_share = {};                   // of the whole scene
  std::size_t differing_pixels = 0;  // against the scene's first picture, over all rounds
  std::string timeline = {};         // of a frame after the rounds, for the most queues that have a core each

  bool shares_cores() const { return sub_devices < queues; }
};

struct ModesRun {
  std::string scene;
  std::size_t n_primitives = 0;
  Machine machine;
  std::uint64_t scene_bytes = 0;
  std::vector<ModesRow> rows;  // [0] is the one core alone
  std::optional<Model> model;
  std::string model_failure;  // why there is none

  const ModesRow* find(const std::string& scheme, int queues) const;  // of those that have figures
  // Times as fast as one core alone; nothing where one of them failed.
  std::optional<double> speed_up(const ModesRow& row) const;
};

std::vector<ModesRun> bench_modes(const ModesOptions& options, const Progress<ModesRun>& progress);

std::size_t count_differing_pixels(std::span<const ModesRun> runs);

// Pixels whose colour is not the same bits; all of the larger picture's where the sizes differ.
std::size_t differing_pixels(const Picture& a, const Picture& b);

// How many times as long a balance of ODPRT takes as the bag of PDPRT: the geometric mean over the scenes
// that have both on so many queues; nothing where none has.
std::optional<double> odprt_over_pdprt(std::span<const ModesRun> runs, const std::string& balance,
                                       int queues);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

// How much faster the thesis found PDPRT than ODPRT.
inline constexpr double kThesisLeast = 0.55, kThesisMost = 0.64;

// What was predicted beside what was measured: seconds, where every queue has a core; of ODPRT rays that were
// sent, always.
struct Check {
  std::string scheme, what;
  int queues = 1;
  double predicted = 0, measured = 0;
  double error() const { return predicted / measured - 1; }
};
std::vector<Check> checks_of(const ModesRun& run);

std::string table_of(const ModesRun& run, const ModesOptions& options);
std::string summary_of(std::span<const ModesRun> runs);
Json json_of(std::span<const ModesRun> runs, const ModesOptions& options);

}  // namespace kdray::bench
