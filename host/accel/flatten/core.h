// What    A scene's faces and its core. A *face* is a plane that bounds the scene's triangles along an axis
//         and has some lying in it, as a floor does; the *core* is the box of everything else, and of
//         zero-area triangles (scene/model/zero_area.h) wherever they lie.
// Why     What is on the inner side of the faces and stays there can only meet the core: one box tells that
//         nothing is in the way of a ray (kernels/shade/open.clh, docs/design/skipping.md). Without faces
//         there is nothing but the studio's floor that rays leave from outside of the core.
#pragma once

#include "accel/flatten/flatten.h"
#include "layout/frame.layout.h"

namespace kdray::flatten {

struct Core {
  vec3 lo = vec3(0), hi = vec3(0);
  vec3 face_lo = vec3(0), face_hi = vec3(0);  // infinite where no triangle lies in the plane
  bool has_faces = false;                     // whose triangles are not in the core
  bool is_known = false;                      // not where there are instances, or nothing beside faces

  // Writes them into the frame, with the lights that are on the inner side of all faces by a thousandth of
  // the scene.
  void apply(layout::Frame& frame, const Array<layout::Light>& lights) const;
};

Core core_of(const FlatScene& scene);

// The same in two steps, for scenes of several parts: bounds of all of their triangles, then for each part
// what lies at these bounds.

// The boxes of the triangles that lie in each of the planes that bound them all, and of all others.
struct Sides {
  Box inner;
  Box at[3][2];  // [axis][0: lo, 1: hi]

  void add(const layout::Triangle& t, const Box& all);
  void grow(const Sides& o);
};
Box triangle_bounds(const FlatScene& scene);
Sides sides_of(const FlatScene& scene, const Box& all);
Core core_of(const Box& all, Sides sides);

}  // namespace kdray::flatten
