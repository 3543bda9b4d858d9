// What    `kdray bench build`: what trees of each quality cost to build and what they gain, scene by scene,
//         beside Embree's medium build; with `variants` the builders of the thesis' chapter 5 too.
// Shape   All builders of a scene take turns; so do their trees with each class of rays. Every tree has to
//         give the hits of the balanced one, bit for bit.
// Errors  Those of scene::load and Renderer. Hits that differ are counted, not thrown.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/build/tree_facts.h"
#include "bench/race/build_race.h"
#include "bench/workload/kinds.h"

namespace kdray::bench {

struct BuildOptions {
  std::vector<std::string> scenes = {};  // empty: the built-in ones
  bool variants = false;
  int rays = 1 << 18;  // of a class, at the most
  int repeat = 5;      // rounds
  bool embree = true;  // beside kdray, where there is one
  std::string device = "auto";
};

struct TraceTimes {
  std::string ray_class;
  std::size_t n_rays = 0;
  Spread seconds;
  std::size_t n_not_identical = 0;  // hits that are not those of the balanced tree
};

struct BuilderResult {
  std::string builder;
  BuildSpreads seconds;
  std::optional<TreeFacts> tree;  // none of Embree's
  std::vector<TraceTimes> traces;

  // Seconds for a million rays of each class.
  double trace_seconds() const;
};

struct BuildRun {
  std::string scene;
  KindCounts n_primitives;  // that can be hit
  std::string device;
  int cores = 0;
  std::vector<BuilderResult> builders;

  const BuilderResult* embree() const;  // the fastest; null without
};

// `done` hears of every scene as soon as it has been measured, `working` what is being measured.
std::vector<BuildRun> bench_build(const BuildOptions& options,
                                  const std::function<void(const BuildRun&)>& done,
                                  const std::function<void(const std::string&)>& working);

std::size_t count_not_identical(std::span<const BuildRun> runs);

// The classes of rays that trees are compared on: primary, diffuse, random.
std::span<const std::string> build_classes();

}  // namespace kdray::bench
