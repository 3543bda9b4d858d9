#include "stress/placed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/query/meshes.h"
#include "stress/table.h"
#include "support/zero_area_meshes.h"

namespace kdray::stress {

namespace {

constexpr std::array<double, 5> kScales{1e-6, 0x1p-10, 1, 1e3, 1e6};
constexpr std::array<double, 4> kSizesAway{0, 1, 1e3, 1e6};

ClosedShape shape_of(std::string name, const scene::Scene& scene) {
  ClosedShape shape{std::move(name), {scene.vertices.begin(), scene.vertices.end()}, {}};
  for (const scene::Triangle& t : scene.triangles)
    shape.triangles.push_back({t.vertex[0], t.vertex[1], t.vertex[2]});
  return shape;
}

void set_bounds(ClosedShape& shape) {
  shape.lo = shape.hi = shape.vertices.front();
  for (const dvec3& v : shape.vertices) shape.lo = glm::min(shape.lo, v), shape.hi = glm::max(shape.hi, v);
}

}  // namespace

double ClosedShape::extent() const {
  const dvec3 e = hi - lo;
  return std::max({e.x, e.y, e.z});
}

std::vector<ClosedShape> ten_closed_shapes() {
  const std::vector<test::LatticeMesh> divided = test::zero_area_meshes();
  std::vector<ClosedShape> shapes{shape_of("cube", cube()),
                                  shape_of("icosphere", test::icosphere(4)),
                                  shape_of("crumpled ball", crumpled()),
                                  shape_of("needle", needle()),
                                  shape_of("torus", test::torus(48, 24)),
                                  shape_of("cubes", test::cubes(7, 6)),
                                  shape_of("slivers", test::slivers(200)),
                                  shape_of("nested boxes", test::nested()),
                                  shape_of("divided box", test::scene_of(divided[1])),
                                  shape_of("divided ball", test::scene_of(divided[4]))};
  for (ClosedShape& shape : shapes) set_bounds(shape);
  return shapes;
}

std::vector<Place> places(std::size_t few_for) {
  std::vector<Place> all;
  for (const double scale : kScales)
    for (const double away : kSizesAway) all.push_back({scale, away});
  if (is_full()) return all;
  return {{1, 0}, all[(7 * few_for + 3) % all.size()]};
}

std::size_t n_placed() {
  std::size_t n = 0;
  for (std::size_t s = 0; s < ten_closed_shapes().size(); ++s) n += places(s).size();
  return n;
}

ClosedShape placed(ClosedShape shape, const Place& place) {
  const dvec3 by = place.sizes_away * shape.extent() * dvec3(1, -0.7, 0.3);
  const dvec3 whole(std::round(by.x), std::round(by.y), std::round(by.z));
  for (dvec3& v : shape.vertices) v = place.scale * (v + whole);
  set_bounds(shape);
  return shape;
}

std::string in_words(const Place& place) {
  return fmt::format("scale {:g}, {:g} sizes away", place.scale, place.sizes_away);
}

Scene committed(const ClosedShape& shape) {
  Scene scene;
  scene.add_mesh({points_of(shape.vertices), shape.triangles}, {.name = shape.name});
  scene.commit();
  return scene;
}

}  // namespace kdray::stress
