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

}  // namespace kdray::verify
