// What    `kdray bench ablation`: what each specialisation and each rule of skipping is worth, by taking it
//         away: time, rays, time to compile, and whether the picture changes.
// Shape   One renderer for a scene, which compiles anew for this run whatever it compiled before. A round is
//         a frame of each variant, each with a usual frame right before it.
// Errors  Those of scene::load and Renderer; ErrorCode::usage for a name that a scene's table doesn't have.
//         Pictures that differ where none may are counted, not thrown.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/progress.h"
#include "bench/measure/report.h"
#include "kdray/kdray.h"
#include "layout/features.h"

namespace kdray::bench {

// What is taken away: a specialisation (the code that a scene doesn't need is compiled in) or a rule (what it
// would leave out is done). A rule is exact where it claims that no bit of the picture depends on it. The two
// that are not leave out light below --min-weight, and what is deeper than --depth.
struct Ablation {
  std::string name;  // of what is taken away
  enum class Kind { none, specialisation, rule, everything } kind = Kind::none;
  bool exact = true;
  std::uint64_t keep = 0;       // api::Hooks::keep
  bool min_weight_off = false;  // rays are spawned whatever they weigh, unless nothing
  bool twice_as_deep = false;
};

const char* name_of(Ablation::Kind kind);

// All that can be taken from frames with this mask of features; last everything that is exact at once.
std::vector<Ablation> ablations_for(layout::Features features);

RenderOptions with(const Ablation& ablation, RenderOptions options);

struct AblationOptions {
  std::vector<std::string> scenes = {"balls", "gears", "mount", "rings",  "teapot",
                                     "tetra", "tree",  "boxes", "spheres"};
  int width = 1024, height = 1024, depth = 5;
  int repeat = 5;  // rounds
  std::string device = "auto";
  std::vector<std::string> only = {};  // by the names in the table; empty: all
};

struct AblationRow {
  Ablation ablation;
  Spread seconds;                             // seconds.render
  Spread ratio;                               // over the usual frame right before
  std::optional<double> compile_seconds;      // none: the same kernels as with nothing taken away
  std::map<std::string, std::uint64_t> rays;  // by kind, and "total"
  std::size_t n_differing = 0;                // values of the picture with other bits
  double largest_difference = 0;
};

struct AblationRun {
  std::string scene, device;
  std::size_t n_primitives = 0;
  std::vector<std::string> on, off;  // features
  std::vector<AblationRow> rows;     // the first: nothing taken away
};

std::vector<AblationRun> bench_ablation(const AblationOptions& options,
                                        const Progress<AblationRun>& progress);

// Rows that claim to be exact and are not.
std::size_t count_inexact(std::span<const AblationRun> runs);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

std::string table_of(const AblationRun& run);
Json json_of(std::span<const AblationRun> runs, const AblationOptions& options);

}  // namespace kdray::bench
