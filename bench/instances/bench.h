// What    `kdray bench instances`: the same rays through a scene with instances and through its flattened
//         copy, by kdray's walks and by Embree's modes, in the same rounds.
// Errors  Those of scene::load and Renderer. Hits of one form that differ between walks are counted, not
//         thrown.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/measure/progress.h"
#include "bench/race/race.h"

namespace kdray::bench {

struct InstancesOptions {
  std::vector<std::string> meshes;           // files or built-in scenes; empty: a ball of 75,000 triangles
  std::vector<double> apart = {};            // empty: 1, 0.5 and 0.25
  int across = 5;                            // so many in a row, and rows
  std::vector<std::string> classes = {};     // empty: primary, shadow, diffuse, random
  std::vector<std::string> traversals = {};  // empty: all that follow instances
  int rays = 1 << 20;                        // of a class, at the most
  int repeat = 7;                            // rounds
  int cores = 0;                             // 0: all
  bool embree = true;                        // beside kdray, where there is one
  std::string device = "auto";
};

// What follows instances: all traversals but `binary`.
std::vector<std::string_view> instance_traversals();

// One walk or mode, through both forms.
struct Pair {
  Outcome instances, copies;

  std::size_t n_not_identical() const { return instances.n_not_identical + copies.n_not_identical; }
  double times() const { return instances.seconds.median / copies.seconds.median; }
};

struct InstancesClass {
  std::string name;
  bool any_hit = false;
  std::size_t n_rays = 0, n_hits = 0;
  double differing_share = 0;  // of kdray's hits, between the forms
  std::vector<Pair> pairs;
};

// A flock on a number of cores.
struct InstancesRun {
  std::string mesh;
  double apart = 0;
  std::size_t n_instances = 0, n_triangles = 0;         // of the mesh
  std::uint64_t instances_bytes = 0, copies_bytes = 0;  // of kdray's scenes on the device
  Machine machine;
  std::vector<InstancesClass> classes;
};

std::vector<InstancesRun> bench_instances(const InstancesOptions& options,
                                          const Progress<InstancesRun>& progress);

// Hits that were not those of the form's first walk, over all runs.
std::size_t count_not_identical(std::span<const InstancesRun> runs);

// The times of the family's fastest with instances over the fastest with copies; 0 where there is none.
double times_copies(const InstancesClass& c, Family family);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

std::string table_of(const InstancesRun& run);
Json json_of(std::span<const InstancesRun> runs, const InstancesOptions& options);

}  // namespace kdray::bench
