// What    `kdray bench rays`: the same rays through kdray's traversals and Embree's modes, scene by scene, on
//         one core and on all.
// Errors  Those of scene::load and Renderer. Hits that differ between kdray's traversals are counted, not
//         thrown.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/measure/progress.h"
#include "bench/race/race.h"
#include "bench/workload/kinds.h"

namespace kdray::bench {

struct RaysOptions {
  std::vector<std::string> scenes = {};                    // empty: default_scenes()
  std::vector<std::string> classes = {}, traversals = {};  // empty: all
  int rays = 1 << 20;                                      // of a class, at the most
  int repeat = 7;                                          // rounds
  std::vector<int> cores = {};                             // 0: all; empty: 1 and all, on a GPU all
  bool embree = true;                                      // beside kdray, where there is one
  std::string device = "auto";
};

struct ClassResult {
  std::string name;
  bool any_hit = false;
  std::size_t n_rays = 0, n_hits = 0;
  std::vector<Outcome> outcomes;
};

// Primitives of all kinds, a meadow of instances, meshes of 50 thousand to 10 million triangles, and the
// rooms and scans that are there (bench/workload/scenes.h).
std::vector<std::string> default_scenes();

// A scene on a number of cores.
struct RaysRun {
  std::string scene;
  KindCounts n_primitives;
  std::size_t n_instances = 0;
  Machine machine;
  std::vector<ClassResult> classes;
};

std::vector<RaysRun> bench_rays(const RaysOptions& options, const Progress<RaysRun>& progress);

// kdray's hits that were not those of its binary traversal, over all runs.
std::size_t count_not_identical(std::span<const RaysRun> runs);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

std::string table_of(const RaysRun& run);
Json json_of(std::span<const RaysRun> runs, const RaysOptions& options);

}  // namespace kdray::bench
