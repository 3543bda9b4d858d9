// What    The mesh's topology: which edges have one face, more than two, or two that disagree about which
//         side is the front; the components that faces form over common edges, and which of those are
//         watertight.
// Shape   A component is watertight when each of its edges has an even number of faces: then it parts space
//         into an inside and an outside, whichever way its faces are turned. It is closed when it is
//         watertight, each edge has two faces, and those agree.
//         Flipped faces are the fewer of the two classes into which agreement divides the faces that are
//         joined by edges of two; a surface with one side (a Moebius strip) has no such classes.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "apps/verify/mesh.h"

namespace kdray::verify {

struct Edge {
  std::uint32_t a, b;      // points, a < b
  std::uint32_t triangle;  // one of its faces
};

struct Component {
  std::uint32_t faces = 0, open_edges = 0, crowded_edges = 0, turned_edges = 0, flipped = 0;
  bool watertight = true;  // no edge with an odd number of faces
  bool one_sided = false;
  double volume = 0;        // of a closed one: negative when it is inside out
  std::uint32_t first = 0;  // its first face
  Box bounds;
  bool closed() const { return watertight && crowded_edges == 0 && turned_edges == 0; }
};

struct Topology {
  std::size_t n_edges = 0;
  std::vector<Edge> open;                   // one face
  std::size_t loops = 0;                    // of open edges: rims of holes, outlines
  std::vector<Edge> crowded;                // more than two
  std::vector<Edge> turned;                 // two faces, one of them turned over
  std::vector<std::uint32_t> flipped;       // faces
  std::vector<Component> components;        // the largest first
  std::vector<std::uint32_t> component_of;  // of each face

  std::size_t count(bool (*what)(const Component&)) const;
};

Topology find_topology(const Mesh& mesh);

// Faces that lie on each other: the same three corners twice, and different faces in one plane that cover
// common ground. `doubled` holds a face of each such triple but for the first; `overlapping` pairs of
// others, each once. Errors: Two faces are in one plane when no corner of either is farther from the
// other's plane than the rounding of the coordinates allows (2^-22 of the largest of them): a plane that
// isn't along the axes has no three floats exactly in it. They overlap when they reach into each other by
// more than four times that, everywhere: what shares an edge or a corner doesn't, nor does what only
// overlaps by rounding. Faces that run alongside each other farther apart are not found. Source: In the
// plane: separating axes, Gottschalk 1996.
struct Duplicates {
  std::vector<std::uint32_t> doubled;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> overlapping;  // the smaller first, sorted
};

Duplicates find_duplicates(const Mesh& mesh, const Boxes& boxes);

// Returns whether the two faces lie in one plane and cover common ground; a face does so with itself.
bool overlap(const Mesh& mesh, std::uint32_t a, std::uint32_t b);

}  // namespace kdray::verify
