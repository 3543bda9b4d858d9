// What    The scene as kdray stores it, rounded to float, as a model again: what an oracle must look at to
//         tell the error of kdray's arithmetic from that of storing.
#pragma once

#include "base/local_space.h"
#include "scene/model/scene.h"

namespace kdray::test {

// In the scene's own space: the rays of a picture are the same, other rays' origins and distances are to be
// taken there.
struct Stored {
  scene::Scene model;
  LocalSpace space;
};

// Every unit vector is one again, in double. The camera of `scene` is kept: one whose numbers float holds is
// stored as it is.
Stored as_stored(const scene::Scene& scene);

// The shape that a struct of the kernels stands for. Each kind has one (tests/primitives/<kind>.cpp).
#define KDRAY_AS_STORED(NAME, name, names, Struct) scene::Struct as_told(const layout::Struct& name);
KDRAY_SHAPES(KDRAY_AS_STORED)
#undef KDRAY_AS_STORED

inline dvec3 dvec3_of(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// A camera that looks along -z from z = `distance` and whose numbers float holds, pictures of 2^k pixels and
// the same width and height assumed.
scene::Camera straight_camera(double height, double distance);

}  // namespace kdray::test
