// What    Ten closed meshes as a program would add them, at scales of 1e-6 to 1e6 and up to a million sizes
//         away, committed to a kdray::Scene: whatever is asked of them goes through the public interface
//         alone.
// Shape   Slivers, edges of four faces, bodies in each other, needles, T-junctions that triangles without
//         area close. A mesh is closed by index wherever it is put, since each vertex is rounded once for all
//         of its triangles.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/vec.h"
#include "kdray/kdray.h"

namespace kdray::stress {

struct ClosedShape {
  std::string name;
  std::vector<dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  const dvec3& corner(std::size_t triangle, std::size_t k) const { return vertices[triangles[triangle][k]]; }
  dvec3 center() const { return (lo + hi) / 2.0; }
  double extent() const;  // the largest of its three

  dvec3 lo{0}, hi{0};  // of the vertices
};

inline constexpr std::size_t kClosedShapes = 10;
std::vector<ClosedShape> ten_closed_shapes();

struct Place {
  double scale, sizes_away;
};
// All of them, or for a quick run `few` that are others for each number.
std::vector<Place> places(std::size_t few_for);

// Scaled about the origin and moved; by a whole number of the shape's own units, so that what lies on a grid
// stays on it wherever doubles have room for that.
ClosedShape placed(ClosedShape shape, const Place& place);
std::string in_words(const Place& place);

Scene committed(const ClosedShape& shape);

// The shapes' many points as arrays that queries take.
inline Points points_of(const std::vector<dvec3>& v) {
  return {&v.data()->x, v.size(), sizeof(dvec3)};
}

// Calls back for each shape at each place of this run, with a number of each, so that random numbers differ.
template <class Visit>
void for_each_placed(const Visit& visit) {
  const std::vector<ClosedShape> shapes = ten_closed_shapes();
  std::uint64_t number = 0;
  for (std::size_t s = 0; s < shapes.size(); ++s)
    for (const Place& place : places(s)) visit(number++, place, placed(shapes[s], place));
}
std::size_t n_placed();

}  // namespace kdray::stress
