#include "stress/lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kdray::stress {

namespace {

std::size_t some_triangle(const ClosedShape& shape, Random& random) {
  return random.below(shape.triangles.size());
}

// Back along the direction by a power of two of times it, until it is outside of all bounds: where direction
// and place lie on a grid, the origin does.
Line through(const ClosedShape& shape, Random& random, const dvec3& at, const dvec3& d) {
  const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  const int far = random.below(4) == 0 ? 3 + static_cast<int>(random.below(18)) : 3;
  const double back = std::ldexp(1.0, std::ilogb(shape.extent() / largest) + far);
  return {at - back * d, d};
}

// From a point around the mesh to one of it.
Line towards(const ClosedShape& shape, Random& random, const dvec3& at) {
  const double far = random.below(4) == 0 ? random.log_uniform(2, 1e6) : 2;
  const dvec3 from = shape.center() + random.direction() * (far * shape.extent());
  return {from, at - from};
}

dvec3 an_axis(Random& random) {
  dvec3 d(0);
  d[static_cast<int>(random.below(3))] = random.sign();
  return d;
}

Line at_random(const ClosedShape& shape, Random& random) {
  const dvec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return through(shape, random, shape.center() + 0.5 * shape.extent() * p, random.direction());
}
Line at_a_corner(const ClosedShape& shape, Random& random) {
  return towards(shape, random, some_corner(shape, random));
}
Line at_an_edge_point(const ClosedShape& shape, Random& random) {
  return towards(shape, random, some_edge_point(shape, random));
}
Line along_an_axis(const ClosedShape& shape, Random& random) {
  const dvec3 at = random.below(2) ? some_corner(shape, random) : some_edge_point(shape, random);
  return through(shape, random, at, an_axis(random));
}
// Components of 0, 1/2, 1 and 2 times the scale: ratios that floats have exactly.
Line along_a_diagonal(const ClosedShape& shape, Random& random) {
  constexpr std::array<double, 4> kSteps{0, 0.5, 1, 2};
  const dvec3 at = random.below(2) ? some_corner(shape, random) : some_edge_point(shape, random);
  dvec3 d(0);
  while (d == dvec3(0))
    for (int k = 0; k < 3; ++k) d[k] = random.sign() * kSteps[random.below(4)];
  return through(shape, random, at, d);
}
// Coordinates of several corners: along the lines of a grid, in planes of faces across an axis.
Line on_the_grid(const ClosedShape& shape, Random& random) {
  const dvec3 at(some_corner(shape, random).x, some_corner(shape, random).y, some_corner(shape, random).z);
  dvec3 d = an_axis(random);
  if (random.below(2)) d += an_axis(random);
  return through(shape, random, at, d == dvec3(0) ? dvec3(1, 0, 0) : d);
}
// Along an edge, or between two points of a face's plane.
Line in_a_face(const ClosedShape& shape, Random& random) {
  const std::size_t t = some_triangle(shape, random);
  const dvec3 a = shape.corner(t, 0), ab = shape.corner(t, 1) - a, ac = shape.corner(t, 2) - a;
  dvec3 d = random.below(3) == 0 ? ab : random.uniform(-1, 1) * ab + random.uniform(-1, 1) * ac;
  if (d == dvec3(0)) d = ac == dvec3(0) ? dvec3(1, 0, 0) : ac;
  return through(shape, random, a + 0.3 * random.uniform() * (ab + ac), d);
}

}  // namespace

dvec3 some_corner(const ClosedShape& shape, Random& random) {
  return shape.corner(some_triangle(shape, random), random.below(3));
}

dvec3 some_edge_point(const ClosedShape& shape, Random& random) {
  const std::size_t t = some_triangle(shape, random);
  const unsigned k = random.below(3);
  const dvec3 a = shape.corner(t, k), b = shape.corner(t, (k + 1) % 3);
  return random.below(2) ? (a + b) / 2.0 : a + random.uniform() * (b - a);
}

const std::array<LineFamily, 7> kLineFamilies{{{"at random", at_random},
                                               {"at vertices", at_a_corner},
                                               {"at points of edges", at_an_edge_point},
                                               {"along axes through them", along_an_axis},
                                               {"along diagonals through them", along_a_diagonal},
                                               {"on the grid of vertices", on_the_grid},
                                               {"in planes of faces", in_a_face}}};

std::string in_words(const Line& line) {
  const dvec3 &o = line.origin, &d = line.direction;
  return fmt::format("origin {:a} {:a} {:a} direction {:a} {:a} {:a}", o.x, o.y, o.z, d.x, d.y, d.z);
}

}  // namespace kdray::stress
