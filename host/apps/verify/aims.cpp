#include "apps/verify/aims.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kdray::verify {

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

Ray ray_from(const vec3& o, const dvec3& direction) {
  const vec3 d(direction);
  return {{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kFar};
}

double largest(const dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

// Returns a direction that floats can hold, from one float point to another place; any direction where they
// are the same.
dvec3 towards(const vec3& from, const dvec3& to, Random& random) {
  const dvec3 way = to - dvec3(from);
  const vec3 held(way);
  return held == vec3(0.0f) || !is_finite(dvec3(held)) ? random.direction() : way;
}

dvec3 along_an_axis(Random& random) {
  dvec3 d(0);
  const auto axis = static_cast<int>(random.below(3));
  d[axis] = random.below(2) == 0 ? 1 : -1;
  if (random.below(2) == 0) d[(axis + 1) % 3] = random.between(-1, 1);  // or in a plane of the axes
  return d;
}

}  // namespace

Aims::Aims(const Subject& subject, const Insides& insides, double clearance, std::uint64_t seed)
    : subject_(subject), insides_(insides), clearance_(clearance), random_(seed) {
  const Topology& topology = subject.topology;
  constexpr std::uint32_t kNone = 0xffffffffu;
  group_of_.assign(topology.components.size(), kNone);
  std::size_t n = 0;
  for (std::size_t c = 0; c < topology.components.size(); ++c) {
    const Component& component = topology.components[c];
    if (!component.watertight || largest(dvec3(component.bounds.extent())) < 64 * clearance) continue;
    group_of_[c] = static_cast<std::uint32_t>(first_of_.size());
    first_of_.push_back(n);
    n += component.faces;
  }
  first_of_.push_back(n);
  faces_.resize(n);
  std::vector<std::size_t> end = first_of_;
  for (std::uint32_t face = 0; face < topology.component_of.size(); ++face) {
    const std::uint32_t group = group_of_[topology.component_of[face]];
    if (group != kNone) faces_[end[group]++] = face;
  }
}

// Looks along the face's normal for a point inside, on either side, less and less deep.
std::optional<InsideOrigin> Aims::move_in(std::uint32_t face) const {
  const Mesh& mesh = subject_.mesh;
  const std::uint32_t component = subject_.topology.component_of[face];
  const dvec3 middle =
      (dvec3(mesh.corner(face, 0)) + dvec3(mesh.corner(face, 1)) + dvec3(mesh.corner(face, 2))) / 3.0;
  const dvec3 normal = mesh.normal(face);
  if (!(glm::length(normal) > 0)) return {};
  const double size = largest(dvec3(subject_.topology.components[component].bounds.extent()));
  for (double depth = 0.3 * size; depth > clearance_; depth *= 0.3) {
    for (const double side : {-1.0, 1.0}) {
      const vec3 point(middle + side * depth * glm::normalize(normal));
      if (insides_.side_of(dvec3(point), component, clearance_) == Side::inside)
        return InsideOrigin{point, component};
    }
  }
  return {};
}

// Half of the origins go to all components in turn, the others by the number of faces.
std::vector<InsideOrigin> Aims::find_origins(std::size_t n) {
  if (faces_.empty()) return {};
  const std::size_t n_groups = first_of_.size() - 1;
  std::vector<std::uint32_t> faces(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t group = (i / 2) % n_groups;
    const bool own = i % 2 == 0;
    const std::size_t first = own ? first_of_[group] : 0, last = own ? first_of_[group + 1] : faces_.size();
    faces[i] = faces_[first + random_.below(last - first)];
  }
  std::vector<std::optional<InsideOrigin>> found(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) { found[i] = move_in(faces[i]); });
  std::vector<InsideOrigin> origins;
  for (const auto& origin : found)
    if (origin) origins.push_back(*origin);
  return origins;
}

// Returns a corner or a place on an edge; without `of_outline` a place anywhere on the triangle.
dvec3 Aims::place_on_triangle(std::size_t triangle, bool of_outline) {
  const Mesh& mesh = subject_.mesh;
  const std::size_t k = random_.below(3);
  const dvec3 a(mesh.corner(triangle, k)), b(mesh.corner(triangle, (k + 1) % 3)),
      c(mesh.corner(triangle, (k + 2) % 3));
  if (!of_outline) {
    const double u = std::sqrt(random_.unit()), v = random_.unit();
    return (1 - u) * a + u * (1 - v) * b + u * v * c;
  }
  switch (random_.below(4)) {
    case 0:
      return 0.5 * a + 0.5 * b;
    case 1: {
      const double u = random_.unit();
      return (1 - u) * a + u * b;
    }
    default:
      return a;
  }
}

Aimed Aims::from_inside(const InsideOrigin& origin) {
  Aimed aimed{{}, origin.component, kNowhere};
  const std::size_t choice = random_.below(8);
  if (choice == 6) {
    aimed.ray = ray_from(origin.point, random_.direction());
  } else if (choice == 7) {
    aimed.ray = ray_from(origin.point, along_an_axis(random_));
  } else {
    const std::size_t group = group_of_[origin.component];
    const std::size_t first = first_of_[group], last = first_of_[group + 1];
    const dvec3 target = place_on_triangle(faces_[first + random_.below(last - first)], true);
    aimed.ray = ray_from(origin.point, towards(origin.point, target, random_));
  }
  return aimed;
}

dvec3 Aims::place_on(std::size_t target) {
  const scene::Geometry& g = subject_.geometry;
  if (target < g.triangles.size()) return place_on_triangle(target, random_.below(4) == 0);
  dvec3 place;
  scene::visit_primitive(g, target, [&](auto kind, std::uint32_t index) {
    if constexpr (decltype(kind)::kIsShape) {
      // Half of the rays go to the outline of what has one.
      const auto& shape = decltype(kind)::of(g)[index];
      const double share = has_outline(shape) && random_.below(2) == 0 ? 1.0 : random_.unit();
      place = primitives::place_on(shape, share, random_.direction());
    }
  });
  return place;
}

Aimed Aims::from_outside() {
  const Box& b = subject_.geometry.bounds;
  const dvec3 middle = 0.5 * dvec3(b.lo) + 0.5 * dvec3(b.hi), half = 0.5 * (dvec3(b.hi) - dvec3(b.lo));
  const dvec3 in_box(random_.between(-1, 1), random_.between(-1, 1), random_.between(-1, 1));
  const dvec3 origin =
      middle + (random_.below(2) == 0 ? 1.5 * glm::length(half) * random_.direction() : half * in_box);
  const std::size_t target = random_.below(subject_.geometry.size());
  vec3 from(origin);
  if (!is_finite(dvec3(from))) from = vec3(middle);  // about a scene as large as floats go
  return {ray_from(from, towards(from, place_on(target), random_)), kNowhere,
          static_cast<std::int64_t>(target)};
}

}  // namespace kdray::verify
