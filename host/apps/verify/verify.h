// What    All checks of a scene: the mesh itself (topology, duplicates), and how soundly kdray traces it
//         (probes, and a picture that is looked through for what is no number); and a picture of where the
//         findings are.
// Shape   The picture (picture.cpp) shows the scene in faint grey, from its own camera and from the opposite
//         side, the findings in colour. What lies behind something shines through, weaker: no finding is
//         hidden. Faces are filled and, small as they may be, marked by a dot; edges are lines; rays that
//         kdray traced wrongly are crosses.
// Errors  What is wrong with the mesh or with kdray is found, not thrown; kdray::Error for what can't be
//         checked: no device, no memory, a scene that can't be traced.
#pragma once

#include <functional>
#include <string>

#include "accel/prepare/prepared.h"
#include "apps/verify/edges.h"
#include "apps/verify/probes.h"
#include "io/image/image.h"
#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::verify {

struct Options {
  std::uint64_t rays = 1 << 18;  // besides those that leave their hits
  int width = 0, height = 0;     // of the picture of the findings; 0: none is wanted
  TreeOptions tree = {};
  DeviceOptions device = {};
  std::function<void(double)> progress = {};  // with the share done, 0 to 1
};

// What was found in a rendered picture of the scene.
struct Film {
  std::uint64_t pixels = 0, not_finite = 0;
  std::string fault;  // what ended the render; empty: nothing
};

struct Seconds {
  double build = 0, mesh = 0, duplicates = 0, probes = 0, film = 0, picture = 0;
};

struct Findings {
  LocalSpace space;           // of places, areas and volumes here
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

inline constexpr int kLeastWidth = 320, kLeastHeight = 200;  // of a picture on which something can be seen

image::Image draw(const Findings& found, const prepare::Prepared& scene, Tracer& tracer, int width,
                  int height);

// Returns which colours the picture has and what they mark: "red: open edges, blue: ..."; empty: it has none.
std::string colors_of(const Findings& found);

}  // namespace kdray::verify
