// What    The flat form of a geometry that comes from no scene.
#pragma once

#include "accel/flatten/flatten.h"

namespace kdray::flatten {

// flatten() wants the scene that the geometry comes from; of it only the counts matter here.
inline FlatScene flat_of(const scene::Geometry& g, const kdtree::Tree& tree) {
  scene::Scene s;
  s.triangles.resize(g.triangles.size());
  primitives::for_each_shape([&](auto kind) { decltype(kind)::of(s).resize(decltype(kind)::of(g).size()); });
  return flatten(s, g, tree);
}

}  // namespace kdray::flatten
