#include "engine/query/closest_scenes.h"

#include <array>
#include <cmath>
#include <numbers>

#include "pictures/stored.h"
#include "scene/primitives/shapes.h"

namespace kdray::test {

void add_triangle(scene::Scene& s, const dvec3& a, const dvec3& b, const dvec3& c) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const dvec3& v : {a, b, c}) s.vertices.push_back(v);
  scene::Triangle t{.vertex = {first, first + 1, first + 2}};
  t.number = s.primitive_count();
  s.triangles.push_back(t);
}

scene::Scene empty_scene() {
  scene::Scene s;
  s.materials.emplace_back();
  return s;
}

// Triangles of sizes that differ by factors of up to 10^`decades`.
scene::Scene soup(int n, double decades) {
  Draw random(kClosestSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i) {
    const dvec3 middle = random.in_cube(1);
    const double size = 0.3 * std::pow(10.0, random.between(-decades, 0));
    add_triangle(s, middle + size * random.direction(), middle + size * random.direction(),
                 middle + size * random.direction());
  }
  return s;
}

// Long ones, a 10^-2 to 10^-7 of their length across.
scene::Scene slivers(int n) {
  Draw random(kClosestSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i) {
    const dvec3 from = random.in_cube(1), way = random.direction();
    const double width = std::pow(10.0, random.between(-7, -2));
    add_triangle(s, from, from + way, from + random.between(0, 1) * way + width * random.direction());
  }
  return s;
}

// A height field over whole numbers, whose corners and edges its triangles share.
scene::Scene grid(int n) {
  Draw random(kClosestSeed);
  scene::Scene s = empty_scene();
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      s.vertices.push_back({double(x), double(y), x < n / 2 ? 0.0 : double(random.below(3))});
  const auto at = [n](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      for (const std::array<std::uint32_t, 3>& corners :
           {std::array{at(x, y), at(x + 1, y), at(x + 1, y + 1)},
            {at(x, y), at(x + 1, y + 1), at(x, y + 1)}}) {
        scene::Triangle t{.vertex = corners};
        t.number = s.primitive_count();
        s.triangles.push_back(t);
      }
  return s;
}

// All of it is equally far from the middle.
scene::Scene ball(int n) {
  scene::Scene s = empty_scene();
  const auto at = [n](int i, int j) {
    const double a = std::numbers::pi * i / n, b = std::numbers::pi * j / n;
    return dvec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      if (i > 0) add_triangle(s, at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + 1 < n) add_triangle(s, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return s;
}

scene::Scene flat_cones(int n) {
  Draw random(kClosestSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i) {
    const dvec3 base = random.in_cube(1);
    const double size = std::pow(10.0, random.between(-2, 0)),
                 radius = size * std::pow(10.0, random.between(-2, 0.5));
    const double apex_radius =
        random.below(3) == 0 ? 0 : (random.below(3) == 0 ? radius : random.between(0, radius));
    s.cones.push_back({base, base + size * random.direction(), radius, apex_radius, 0, s.primitive_count()});
  }
  return s;
}

scene::Scene all_kinds() {
  scene::Scene s = soup(60, 1);
  primitives::for_each_shape([&](auto kind) {
    const scene::Scene some = shapes<decltype(kind)>(40);
    for (auto shape : decltype(kind)::of(some)) {
      shape.number = s.primitive_count();
      decltype(kind)::of(s).push_back(shape);
    }
  });
  return s;
}

scene::Scene moved(scene::Scene s, double scale, const dvec3& by) {
  for (dvec3& v : s.vertices) v = scale * v + by;
  return s;
}

namespace {

dvec3 vec(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// A place on a triangle: inside, and often at a corner or on an edge.
dvec3 place_of(const layout::Triangle& t, Draw& random) {
  double u = random.between(0, 1), v = random.between(0, 1);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const std::size_t choice = random.below(4);
  if (choice == 0) u = v = 0;
  if (choice == 1) v = 0;
  if (choice == 2) u = 0.5, v = 0.5;
  const dvec3 a = vec(t.v[0]);
  return a + u * (vec(t.v[1]) - a) + v * (vec(t.v[2]) - a);
}

std::vector<dvec3> places_on(const DeviceScene& queried, std::size_t n, Draw& random) {
  std::vector<dvec3> places;
  while (places.size() < n)
    primitives::for_each_kind([&](auto kind) {
      using Kind = decltype(kind);
      const auto& all = Kind::of(queried.prepared().flat);
      if (all.size() == 0) return;
      const auto& one = all[random.below(all.size())];
      if constexpr (Kind::kIsShape)
        places.emplace_back(Samples<Kind>::point(geometry_of(as_told(one), LocalSpace{}, 0), random));
      else
        places.push_back(place_of(one, random));
    });
  places.resize(n);
  return places;
}

}  // namespace

std::vector<dvec3> points_for(const DeviceScene& queried, std::size_t n) {
  Draw random(kClosestSeed + 1);
  const LocalSpace& space = queried.space();
  const Box& bounds = queried.prepared().geometry.bounds;
  const dvec3 middle(bounds.center());
  const double half = 0.5 * largest_component(dvec3(bounds.extent()));
  std::vector<dvec3> points;
  const auto add = [&](const dvec3& local) { points.push_back(space.world(local)); };
  for (std::size_t i = 0; i < n / 5; ++i) add(middle + random.in_cube(1.3 * half));
  for (std::size_t i = 0; i < n / 20; ++i)
    add(middle + half * std::pow(10.0, random.between(0, 4)) * random.direction());
  for (std::size_t i = 0; i < n / 20; ++i)
    add(middle + half * std::pow(10.0, random.between(4, 11)) * random.direction());
  for (const dvec3& p : places_on(queried, n / 10, random)) add(p);
  for (const dvec3& p : places_on(queried, n / 3, random))
    add(p + half * std::pow(10.0, random.between(-16, -1)) * random.direction());
  // Whole numbers and halves of the world, which lie above edges and corners of grids.
  for (std::size_t i = 0; i < n / 20; ++i) {
    const dvec3 p = space.world(middle + random.in_cube(1.3 * half));
    points.push_back(dvec3(0.5 * std::round(2 * p.x), 0.5 * std::round(2 * p.y), 0.5 * std::round(2 * p.z)));
  }
  while (points.size() < n) add(middle + random.in_cube(0.5 * half));
  return points;
}

}  // namespace kdray::test
