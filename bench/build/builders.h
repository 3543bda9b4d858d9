// What    kdray's builders by name: the qualities of --build, and those of the thesis that only the bench
//         has; and what is told of the trees that they make, and of their times.
// Source  The thesis' chapter 5: perfect, boxed, spatial median and object median.
#pragma once

#include <string>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/prepare/prepared.h"
#include "bench/race/build_race.h"

namespace kdray::bench {

struct Builder {
  std::string name;
  kdtree::BuildConfig config;
};

// fast, balanced, best; for a scene of n primitives.
std::vector<Builder> quality_builders(std::size_t n_primitives);

// "perfect" (costs over cells, with flat and empty ones), "boxed" (bounds are split, primitives are not
// clipped), "spatial median", "object median".
std::vector<Builder> thesis_builders(std::size_t n_primitives);

// A scene that a tree can be built of.
struct BuildInput {
  explicit BuildInput(const std::string& name);  // loads it; throws ErrorCode::input where it is empty
  explicit BuildInput(scene::Scene&& made) : scene(std::move(made)), geometry(scene::make_geometry(scene)) {}

  scene::Scene scene;
  scene::Geometry geometry;
};

// How large a tree is, and what a ray is expected to cost.
struct TreeFacts {
  double duplication = 0;               // references for each primitive
  double sah_cost = 0, tight_cost = 0;  // as in kdtree::Statistics
  int max_depth = 0;
  std::uint32_t largest_leaf = 0;
  std::size_t binary_bytes = 0, wide_bytes = 0;
};

TreeFacts facts_of(const prepare::Prepared& made);

Json json_of(const BuildSpreads& seconds);
Json json_of(const TreeFacts& tree);

// The columns of a build's times, in milliseconds: tree, flatten, both, their least and most, cpu.
std::string times_heading();
std::string times_cells(const BuildSpreads& seconds);

}  // namespace kdray::bench
