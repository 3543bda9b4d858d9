#include "oracle/primitives.h"

#include <algorithm>
#include <cmath>

#include "oracle/polynomial.h"

namespace kdray::oracle {
namespace {

// The real roots of a*t^2 + 2*b*t + c, ascending; returns how many. Citardauq's form, so that neither root
// suffers from cancellation.
int roots(double a, double b, double c, double t[2]) {
  if (a == 0) {
    if (b == 0) return 0;
    t[0] = -c / (2 * b);
    return 1;
  }
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  t[0] = q / a;
  t[1] = q == 0 ? t[0] : c / q;
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  return 2;
}

using RealVec = glm::vec<3, long double>;

bool within(double t, const Ray& ray) {
  return t >= ray.t_min && t <= ray.t_max;
}

}  // namespace

// A kind that the oracle doesn't know does not compile: here, and in the switches below.
World::World(const scene::Scene& scene) : scene_(scene) {
  DBox box;
  primitives::for_each_kind([&](auto kind) {
    std::uint32_t source = 0;
    for (const auto& p : decltype(kind)::of(scene)) add(p, source++, box);
  });
  std::sort(shapes_.begin(), shapes_.end(),
            [](const Shape& l, const Shape& r) { return l.number < r.number; });
  if (!box.empty()) extent_ = 0.5 * std::max({box.extent().x, box.extent().y, box.extent().z});
}

void World::add(const scene::Triangle& t, std::uint32_t source, DBox& box) {
  const dvec3 p[3] = {scene_.vertices[t.vertex[0]], scene_.vertices[t.vertex[1]],
                      scene_.vertices[t.vertex[2]]};
  for (const dvec3& corner : p) box.grow(corner);
  const dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  if (normal == dvec3(0)) return;  // no area: nothing to hit
  shapes_.push_back({Kind::triangle, source, static_cast<int>(t.number), p[0], p[1], p[2], 0, 0, normal});
}

void World::add(const scene::Sphere& s, std::uint32_t source, DBox& box) {
  box.grow(s.center - s.radius), box.grow(s.center + s.radius);
  shapes_.push_back({Kind::sphere, source, static_cast<int>(s.number), s.center, {}, {}, s.radius, 0, {}});
}

void World::add(const scene::Cone& c, std::uint32_t source, DBox& box) {
  const double r = std::max(c.base_radius, c.apex_radius);
  for (const dvec3& end : {c.base, c.apex}) box.grow(end - r), box.grow(end + r);
  shapes_.push_back(
      {Kind::cone, source, static_cast<int>(c.number), c.base, c.apex, {}, c.base_radius, c.apex_radius, {}});
}

void World::add(const scene::Disc& d, std::uint32_t source, DBox& box) {
  box.grow(d.center - d.radius), box.grow(d.center + d.radius);
  const dvec3 normal = glm::normalize(d.normal);
  shapes_.push_back({Kind::disc, source, static_cast<int>(d.number), d.center, {}, {}, d.radius, 0, normal});
}

void World::add(const scene::Torus& t, std::uint32_t source, DBox& box) {
  const double size = t.major_radius + t.minor_radius;
  box.grow(t.center - size), box.grow(t.center + size);
  shapes_.push_back({Kind::torus,
                     source,
                     static_cast<int>(t.number),
                     t.center,
                     {},
                     {},
                     t.major_radius,
                     t.minor_radius,
                     glm::normalize(t.axis)});
}

Hit World::closest(const Ray& ray, double grow) const {
  Hit best;
  Ray rest = ray;  // as far as the nearest hit yet
  for (const Shape& shape : shapes_) {
    const Hit hit = intersect(shape, rest, grow);
    if (!hit.found() || hit.t >= best.t) continue;  // ascending numbers: on a tie the smaller one stays
    best = hit;
    rest.t_max = hit.t;
  }
  return best;
}

bool World::occluded(const Ray& ray) const {
  return std::any_of(shapes_.begin(), shapes_.end(), [&](const Shape& shape) {
    const Hit hit = intersect(shape, ray, 0);
    return hit.found() && hit.t > ray.t_min && hit.t < ray.t_max;
  });
}

Hit World::intersect(const Shape& shape, const Ray& ray, double grow) const {
  switch (shape.kind) {
    case Kind::triangle:
      return intersect_triangle(shape, ray, grow);
    case Kind::sphere:
      return intersect_sphere(shape, ray, grow);
    case Kind::cone:
      return intersect_cone(shape, ray, grow);
    case Kind::disc:
      return intersect_disc(shape, ray, grow);
    case Kind::torus:
      return intersect_torus(shape, ray, grow);
  }
  return {};
}

// Cuts the ray with the plane, then asks on which side of each edge the point lies.
Hit World::intersect_triangle(const Shape& s, const Ray& ray, double grow) const {
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

Hit World::intersect_sphere(const Shape& s, const Ray& ray, double grow) const {
  const double radius = s.r0 + grow;
  if (radius <= 0) return {};
  const dvec3 o = ray.origin - s.a;
  // The origin lies on the surface itself: one root is 0 by definition, not by what rounding left of it.
  const double c = ray.self == s.number ? 0 : glm::dot(o, o) - radius * radius;
  double t[2];
  const int n = roots(glm::dot(ray.direction, ray.direction), glm::dot(o, ray.direction), c, t);
  for (int i = 0; i < n; ++i)
    if (within(t[i], ray)) return {t[i], s.number};
  return {};
}

// The points whose distance from the axis equals r0 + k*h, h being the way along the axis from the base.
Hit World::intersect_cone(const Shape& s, const Ray& ray, double grow) const {
  const double length = glm::length(s.b - s.a);
  const dvec3 axis = (s.b - s.a) / length;
  const double k = (s.r1 - s.r0) / length;
  const dvec3 o = ray.origin - s.a;
  const double h0 = glm::dot(o, axis), dh = glm::dot(ray.direction, axis);
  const dvec3 across = o - h0 * axis, d_across = ray.direction - dh * axis;
  const double radius = s.r0 + grow + k * h0;
  const double a = glm::dot(d_across, d_across) - k * k * dh * dh;
  const double b = glm::dot(across, d_across) - k * radius * dh;
  const double c = ray.self == s.number ? 0 : glm::dot(across, across) - radius * radius;
  double t[2];
  const int n = roots(a, b, c, t);
  for (int i = 0; i < n; ++i) {
    const double h = h0 + t[i] * dh;
    // Grown radii make a second nappe begin inside the segment of a pointed cone: its radius is negative.
    const bool on_segment = h >= -grow && h <= length + grow && s.r0 + grow + k * h >= 0;
    if (on_segment && within(t[i], ray)) return {t[i], s.number, std::clamp(h / length, 0.0, 1.0), 0};
  }
  return {};
}

// Cuts the ray with the plane, as a triangle does; there it asks for the distance from the centre.
Hit World::intersect_disc(const Shape& s, const Ray& ray, double grow) const {
  if (ray.self == s.number) return {};
  const double slope = glm::dot(ray.direction, s.normal);
  if (slope == 0) return {};
  const double t = glm::dot(s.a - ray.origin, s.normal) / slope;
  if (!within(t, ray)) return {};
  const double away = glm::length(ray.origin + t * ray.direction - s.a);
  const double moved = grow * glm::length(ray.direction) / std::abs(slope);
  if (!(away <= s.r0 + moved)) return {};
  return {t, s.number, std::min(away / s.r0, 1.0), 0};
}

// About the point of the line that is nearest to the centre.
Hit World::intersect_torus(const Shape& s, const Ray& ray, double grow) const {
  const long double major = s.r0, minor = s.r1 + grow;
  if (minor <= 0) return {};
  const RealVec d(ray.direction), n = glm::normalize(RealVec(s.normal)),
                                  f = RealVec(ray.origin) - RealVec(s.a);
  const long double a = glm::dot(d, d), middle = -glm::dot(f, d) / a;
  const RealVec g = f + middle * d;
  const auto quartic = torus_quartic<long double>(glm::dot(g, g), glm::dot(g, d), a, glm::dot(g, n),
                                                  glm::dot(d, n), major, minor);
  const long double reach = 2 * (major + minor) / std::sqrt(a);
  std::vector<long double> all = roots_of<long double>(quartic, -reach, reach, 80);
  // The origin lies on the surface itself.
  const auto nearest = std::ranges::min_element(all, {}, [&](long double t) { return std::abs(middle + t); });
  if (ray.self == s.number && nearest != all.end() &&
      std::abs(middle + *nearest) * std::sqrt(a) < 1e-6L * major)
    all.erase(nearest);
  for (const long double t : all)
    if (const double at = static_cast<double>(middle + t); within(at, ray)) return {at, s.number};
  return {};
}

Surface World::surface(const Ray& ray, const Hit& hit) const {
  const auto found = std::lower_bound(shapes_.begin(), shapes_.end(), hit.primitive,
                                      [](const Shape& s, int number) { return s.number < number; });
  Surface out;
  out.point = ray.origin + hit.t * ray.direction;
  switch (found->kind) {
    case Kind::triangle:
      triangle_surface(*found, hit, out);
      break;
    case Kind::sphere:
      out.material = scene_.spheres[found->source].material;
      out.outward = glm::normalize(out.point - found->a);
      break;
    case Kind::torus: {
      out.material = scene_.tori[found->source].material;
      const dvec3 o = out.point - found->a;
      const double along = glm::dot(o, found->normal);
      out.outward = glm::normalize(o - found->r0 * glm::normalize(o - along * found->normal));
      break;
    }
    case Kind::disc:
      out.material = scene_.discs[found->source].material;
      out.outward = found->normal;
      break;
    case Kind::cone: {
      out.material = scene_.cones[found->source].material;
      const double length = glm::length(found->b - found->a);
      const dvec3 axis = (found->b - found->a) / length;
      const dvec3 o = out.point - found->a;
      const dvec3 across = o - glm::dot(o, axis) * axis;
      const double radius = glm::length(across);
      // At the very point of a cone there is no normal: the axis, away from the body, is as good as any.
      const double k = (found->r1 - found->r0) / length;
      out.outward = radius > 0 ? glm::normalize(across / radius - k * axis) : axis * (k < 0 ? 1.0 : -1.0);
      break;
    }
  }
  if (!out.smooth) out.shading = out.outward;
  return out;
}

void World::triangle_surface(const Shape& shape, const Hit& hit, Surface& out) const {
  const scene::Triangle& t = scene_.triangles[shape.source];
  out.material = t.material;
  out.outward = glm::normalize(shape.normal);
  if (t.normal[0] == scene::kNone) return;
  out.weight[0] = 1 - hit.u - hit.v, out.weight[1] = hit.u, out.weight[2] = hit.v;
  const dvec3 corner[3] = {shape.a, shape.b, shape.c};
  dvec3 sum(0);
  for (int i = 0; i < 3; ++i) {
    out.corner[i] = corner[i];
    out.corner_normal[i] = dvec3(scene_.normals[t.normal[i]]);
    sum += out.weight[i] * out.corner_normal[i];
  }
  if (glm::length(sum) == 0) return;  // opposite normals cancel out: flat after all
  out.smooth = true;
  out.shading = glm::normalize(sum);
}

}  // namespace kdray::oracle
