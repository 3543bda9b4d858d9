// Triangles in tests: by the textbook in double, random ones, in exact arithmetic, and hostile ones.
#include <algorithm>
#include <cmath>
#include <limits>

#include "conformance/samples.h"
#include "engine/query/exact_distance.h"
#include "oracle/primitives.h"
#include "stress/exact.h"
#include "stress/self_hits.h"

// ---- As the oracle has them (oracle/primitives.h).
namespace kdray::oracle {

std::optional<Shape> shape_of(const scene::Scene& scene, const scene::Triangle& t, DBox& box) {
  const dvec3 p[3] = {scene.vertices[t.vertex[0]], scene.vertices[t.vertex[1]], scene.vertices[t.vertex[2]]};
  for (const dvec3& corner : p) box.grow(corner);
  const dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  if (normal == dvec3(0)) return {};  // no area: nothing to hit
  return Shape{.a = p[0], .b = p[1], .c = p[2], .normal = normal};
}

// Cuts the ray with the plane, then asks on which side of each edge the point lies.
Hit intersect(primitives::TriangleKind, const Shape& s, const Ray& ray, double grow) {
  if (ray.self == s.number) return {};  // a plane is cut once only
  const dvec3& normal = s.normal;
  const double slope = glm::dot(ray.direction, normal);
  if (slope == 0) return {};
  const double t = glm::dot(s.a - ray.origin, normal) / slope;
  if (!within(t, ray)) return {};
  const dvec3 p = ray.origin + t * ray.direction;
  const double area = glm::dot(normal, normal);
  const double weight[3] = {glm::dot(glm::cross(s.b - p, s.c - p), normal) / area,
                            glm::dot(glm::cross(s.c - p, s.a - p), normal) / area,
                            glm::dot(glm::cross(s.a - p, s.b - p), normal) / area};
  double slack[3] = {0, 0, 0};
  if (grow != 0) {
    // A ray moved by `grow` moves the point by grow/cos in the plane; weight i falls by 1 over the triangle's
    // height.
    const double n = std::sqrt(area);
    const double moved = grow * n * glm::length(ray.direction) / std::abs(slope);
    const double edge[3] = {glm::length(s.c - s.b), glm::length(s.a - s.c), glm::length(s.b - s.a)};
    for (int i = 0; i < 3; ++i) slack[i] = moved * edge[i] / n;
  }
  for (int i = 0; i < 3; ++i)
    if (!(weight[i] >= -slack[i])) return {};
  return {t, s.number, weight[1], weight[2]};
}

void put_surface(primitives::TriangleKind, const scene::Scene& scene, const Shape& shape, const Hit& hit,
                 Surface& out) {
  const scene::Triangle& t = scene.triangles[shape.source];
  out.outward = glm::normalize(shape.normal);
  if (t.normal[0] == scene::kNone) return;
  out.weight[0] = 1 - hit.u - hit.v, out.weight[1] = hit.u, out.weight[2] = hit.v;
  const dvec3 corner[3] = {shape.a, shape.b, shape.c};
  dvec3 sum(0);
  for (int i = 0; i < 3; ++i) {
    out.corner[i] = corner[i];
    out.corner_normal[i] = dvec3(scene.normals[t.normal[i]]);
    sum += out.weight[i] * out.corner_normal[i];
  }
  if (glm::length(sum) == 0) return;  // opposite normals cancel out: flat after all
  out.smooth = true;
  out.shading = glm::normalize(sum);
}

}  // namespace kdray::oracle

namespace kdray::test {

// ---- Random ones (conformance/samples.h).

template <>
void Samples<primitives::TriangleKind>::add(scene::Scene& s, std::uint32_t material, Draw& random) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  const dvec3 middle = random.in_cube(1);
  const double size = random.size();
  for (int i = 0; i < 3; ++i) s.vertices.push_back(middle + size * random.direction());
  scene::Triangle t{.vertex = {first, first + 1, first + 2}};
  t.material = material, t.number = next_number(s);
  s.triangles.push_back(t);
}
template <>
RealPoint Samples<primitives::TriangleKind>::point(const scene::TriangleGeometry& t, Draw& random) {
  Real u = random.between(0, 1), v = random.between(0, 1);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  if (random.below(4) == 0) u = 0;
  const RealPoint a(scene::vertex(t, 0)), b(scene::vertex(t, 1)), c(scene::vertex(t, 2));
  return (1 - u - v) * a + u * b + v * c;
}
// A corner, the middle of an edge, the middle of all.
template <>
Place Samples<primitives::TriangleKind>::place(const scene::Scene& s, std::size_t i, Draw& random) {
  const auto corner = [&](std::size_t k) { return s.vertices[s.triangles[i].vertex[k % 3]]; };
  const std::size_t k = random.below(3);
  const dvec3 edge = corner(k + 1) - corner(k);
  const dvec3 points[] = {corner(k), corner(k) + 0.5 * edge, (corner(0) + corner(1) + corner(2)) / 3.0};
  return {points[random.below(3)], edge};
}

// ---- How far a point is, exactly (engine/query/exact_distance.h).

namespace {

// The least of the three edges' distances, and of the plane's where the foot lies inside.
template <class N>
N distance(const dvec3& point, const layout::Triangle& t) {
  const Vec<N> p = vec<N>(point), a = vec<N>(t.v[0]), b = vec<N>(t.v[1]), c = vec<N>(t.v[2]);
  N square = square_to_segment(p, a, b);
  square = std::min(square, square_to_segment(p, b, c));
  square = std::min(square, square_to_segment(p, c, a));
  const Vec<N> n = cross(minus(b, a), minus(c, a));
  const auto inside = [&](const Vec<N>& from, const Vec<N>& to) {
    return dot(cross(n, minus(to, from)), minus(p, from)) >= 0;
  };
  if (inside(a, b) && inside(b, c) && inside(c, a)) {
    const N height = dot(n, minus(p, a));
    square = std::min(square, N(height * height / dot(n, n)));
  }
  return root(square);
}

}  // namespace

KDRAY_DEFINE_DISTANCES(Triangle)

}  // namespace kdray::test

// ---- In exact arithmetic, and hostile ones (stress/exact.h, stress/self_hits.h).
namespace kdray::stress {

std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Triangle& triangle) {
  const Exact3 a = exactly(triangle.v[0]);
  const Exact3 n = cross(minus(exactly(triangle.v[1]), a), minus(exactly(triangle.v[2]), a));
  const Exact along = dot(d, n);
  if (sgn(along) == 0) return {};
  return {Exact(dot(minus(a, o), n) / along)};
}

double distance(const Exact3& p, const layout::Triangle& triangle) {
  const Exact3 a = exactly(triangle.v[0]);
  const Exact3 n = cross(minus(exactly(triangle.v[1]), a), minus(exactly(triangle.v[2]), a));
  return std::abs(Exact(dot(minus(p, a), n) / sqrt(dot(n, n))).get_d());
}

namespace {

void add_triangle(scene::Scene& s, const std::array<dvec3, 3>& v) {
  scene::Triangle t;
  for (std::size_t k = 0; k < 3; ++k) {
    t.vertex[k] = static_cast<std::uint32_t>(s.vertices.size());
    s.vertices.push_back(dvec3(vec3(v[k])));
  }
  t.number = s.primitive_count();
  s.triangles.push_back(t);
}

dvec3 point_of_any_size(Random& random, double lo, double hi) {
  return {random.signed_log_uniform(lo, hi), random.signed_log_uniform(lo, hi),
          random.signed_log_uniform(lo, hi)};
}

scene::Scene triangles_of_any_coordinates(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    add_triangle(s, {point_of_any_size(random, 1e-8, 1e8), point_of_any_size(random, 1e-8, 1e8),
                     point_of_any_size(random, 1e-8, 1e8)});
  }
  return s;
}

// Sizes from a millionth of the distance from the origin to ten times that. (Nearer to the origin, beside a
// scene of this size, products of their lengths would be below what floats hold: base/local_space.h.)
scene::Scene triangles_of_any_size(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const dvec3 middle = random.log_uniform(1e-3, 1e8) * random.direction();
    const double size = glm::length(middle) * random.log_uniform(1e-6, 10);
    add_triangle(s, {middle + size * random.direction(), middle + size * random.direction(),
                     middle + size * random.direction()});
  }
  return s;
}

scene::Scene triangles_across_axes(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double size = random.log_uniform(1e-8, 1e8);
    const int axis = i % 3;
    std::array<dvec3, 3> v;
    const double at = random.below(4) == 0 ? 0 : size * random.uniform(-1, 1);
    for (dvec3& p : v) {
      p = size * random.direction();
      p[axis] = at;
    }
    add_triangle(s, v);
  }
  return s;
}

}  // namespace

std::vector<Family> families_of(primitives::TriangleKind) {
  return {{"triangles, coordinates 1e-8 to 1e8", triangles_of_any_coordinates, 0.3},
          {"triangles, sizes 1e-14 to 1e9", triangles_of_any_size, 0.2},
          {"triangles across the axes", triangles_across_axes, 0.1}};
}

Spot spot_on(const layout::Triangle& t, Random& random) {
  const dvec3 a = point3(t.v[0]), e1 = point3(t.v[1]) - a, e2 = point3(t.v[2]) - a, w = random.weights();
  return {a + w.y * e1 + w.z * e2, glm::normalize(glm::cross(e1, e2)),
          std::max(glm::length(e1), glm::length(e2))};
}

float radius_at(const layout::Triangle&, const dvec3&) {
  return std::numeric_limits<float>::infinity();
}

Verdict judge(const layout::Triangle& surface, const Ray& ray, const Hit&, const Departure& departure) {
  return judge_flat(surface, ray, departure);
}

}  // namespace kdray::stress
