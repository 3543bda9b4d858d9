// What    A prepared scene whose vertices have moved since its tree was built: the same tree, fitted to where
//         its triangles are now (docs/design/refit.md).
// Shape   What is returned shares what hasn't changed with `last`, and changes nothing of it: others may be
//         tracing it.
#pragma once

#include <memory>
#include <optional>

#include "accel/flatten/refit.h"
#include "accel/prepare/prepared.h"

namespace kdray::prepare {

// A tree as it was built, and what every refit of it needs.
struct Fitting {
  flatten::Pieces pieces;
  double cost = 0;  // flatten::expected_cost() of the form as it was built

  explicit Fitting(const Prepared& built);
};

struct Refitted {
  std::optional<Prepared> scene;  // nothing: it has to be built anew
  double growth = 1;              // of what a ray is expected to cost, since the tree was built
};

// Fits `last`, the scene as it was built or a refit of that, to the vertices of `scene`. Returns no scene
// where it doesn't keep its space, where a triangle has lost its area (degenerate or not) or got it back, and
// where the cost has grown by more than `most_growth`. Assumes that shapes are the same.
Refitted refit(const scene::Scene& scene, const Prepared& last, const Fitting& fitting, double most_growth);

}  // namespace kdray::prepare
