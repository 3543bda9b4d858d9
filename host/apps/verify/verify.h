// What    All checks of a scene: the mesh itself (topology, duplicates), and how soundly kdray traces it
//         (probes, and a picture that is looked through for what is no number).
// Errors  What is wrong with the mesh or with kdray is found, not thrown; kdray::Error for what can't be
//         checked: no device, no memory, a scene that can't be traced.
#pragma once

#include <functional>
#include <string>

#include "accel/prepare/prepared.h"
#include "apps/verify/duplicates.h"
#include "apps/verify/edges.h"
#include "apps/verify/probes.h"
#include "io/image/image.h"
#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::verify {

struct Options {
  std::uint64_t rays = 1 << 18;  // and those that leave their hits
  int width = 0, height = 0;     // of the picture of where; 0: none is wanted
  TreeOptions tree = {};
  DeviceOptions device = {};
  std::function<void(double)> progress = {};  // with the share done, 0 to 1
};

// The scene as kdray renders it, looked through.
struct Film {
  std::uint64_t pixels = 0, not_finite = 0;
  std::string fault;  // what ended the render; empty: nothing
};

struct Seconds {
  double build = 0, mesh = 0, duplicates = 0, probes = 0, film = 0, picture = 0;
};

struct Findings {
  LocalSpace space;           // that places, areas and volumes here are in
  prepare::Counts counts;     // of what can be hit
  std::uint32_t dropped = 0;  // that are degenerate
  Mesh mesh;
  Topology topology;
  Duplicates duplicates;
  Probes probes;
  Film film;
  image::Image picture;
  Seconds seconds;

  bool mesh_is_sound() const;  // nothing open, crowded, flipped, doubled or dropped
  bool kdray_is_sound() const;
};

Findings verify(const scene::Scene& scene, const Options& options);

}  // namespace kdray::verify
