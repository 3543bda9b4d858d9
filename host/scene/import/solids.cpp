#include "scene/import/solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/local_space.h"

namespace kdray::scene {

namespace {

constexpr double kSeal = 0x1p-20;   // of the scene's largest extent
constexpr double kPoint = 0x1p-10;  // of the height
constexpr double kFar = 100;        // how far planes reach, in sizes of all that has one

std::uint32_t next_number(const Scene& part) {
  return part.primitive_count();
}

Disc lid_of(const Closed& c, bool at_apex, double inwards, double beyond) {
  const dvec3 axis = c.apex - c.base;
  const double height = safe_length(axis);
  const dvec3 up = safe_normalize(axis);
  const double slope = std::abs(c.apex_radius - c.base_radius) / height;
  // Rays that pass right by a point may miss the wall, whose quadratic then cancels to less than floats hold:
  // its lid lies where there is some width again.
  const bool pointed = (at_apex ? c.apex_radius : c.base_radius) == 0;
  const double deep = pointed ? std::max(inwards * (1 + 2 / slope), kPoint * height) : inwards;
  const double share = std::min(deep / height, 0.25);  // of a flat one, which can't be parted by more
  const double s = at_apex ? 1 - share : share;
  Disc disc{};
  disc.center = c.base + axis * s;
  disc.normal = at_apex ? up : -up;
  disc.radius = c.base_radius + (c.apex_radius - c.base_radius) * s + beyond * (1 + slope);
  return disc;
}

// Of all that isn't a plane, with who looks at it and what lights it; planes have their points in it.
DBox size_of(const Scene& scene) {
  DBox box = scene.bounds();
  if (scene.camera) box.grow(scene.camera->from);
  for (const Light& light : scene.lights)
    if (light.kind != LightKind::directional) box.grow(light.position);
  return box;
}

double largest_side(const DBox& box) {
  return box.empty() ? 0 : largest_component(box.hi - box.lo);
}

dvec3 foot_of(const dvec3& point, const Plane& plane) {
  return point - plane.normal * glm::dot(point - plane.point, plane.normal);
}

// Returns the box of what a camera that is made up looks at: of planes without end the points below the
// middle of all else, and not how far they were made to reach.
DBox box_to_show(std::span<const Unsettled::Wide> planes, Scene& scene) {
  std::vector<Disc> discs = scene.discs;
  for (const auto& [plane, number] : planes) discs[number].radius = plane.extent > 0 ? plane.extent : -1;
  std::erase_if(discs, [](const Disc& disc) { return disc.radius < 0; });
  std::swap(discs, scene.discs);
  DBox box = scene.bounds();
  std::swap(discs, scene.discs);
  if (box.empty()) return box;
  const dvec3 middle = box.center();
  for (const auto& [plane, number] : planes)
    if (!(plane.extent > 0)) box.grow(foot_of(middle, plane));
  return largest_side(box) > 0 ? box : DBox{};
}

void settle_planes(std::span<const Unsettled::Wide> planes, Scene& scene) {
  const DBox box = size_of(scene), shown = box_to_show(planes, scene);
  const double side = largest_side(box), size = side > 0 ? side : 1;
  for (const auto& [plane, number] : planes) {
    Disc& disc = scene.discs[number];
    disc.radius = plane.extent > 0 ? plane.extent : kFar * size;
    if (plane.extent > 0) continue;
    scene.framing.box = shown;
    if (!box.empty()) disc.center = foot_of(box.center(), plane);
  }
}

}  // namespace

void add_box(Scene& part, const dvec3& corner, const dvec3& opposite) {
  const dvec3 lo = glm::min(corner, opposite), hi = glm::max(corner, opposite);
  const auto first = static_cast<std::uint32_t>(part.vertices.size());
  for (std::uint32_t i = 0; i < 8; ++i)
    part.vertices.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
  // Counter-clockwise from outside.
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& face : kFaces)
    for (const std::array<std::uint32_t, 3>& pick : {std::array{0u, 1u, 2u}, {0u, 2u, 3u}}) {
      Triangle t{.vertex = {first + face[pick[0]], first + face[pick[1]], first + face[pick[2]]}};
      t.number = next_number(part);
      part.triangles.push_back(t);
    }
}

void add_box_texcoords(Scene& box) {
  const dvec3 lo = box.vertices.front(), size = box.vertices.back() - lo;
  for (const Triangle& t : box.triangles) {
    const auto corner = [&](std::size_t i) { return (box.vertices[t.vertex[i]] - lo) / size; };
    const dvec3 a = corner(0), outwards = glm::cross(corner(1) - a, corner(2) - a);
    layout::TexCoords at{};
    for (std::size_t i = 0; i < 3; ++i) {
      const dvec3 p = corner(i);
      glm::dvec2 uv(outwards.z > 0 ? p.x : 1 - p.x, 1 - p.y);
      if (outwards.x != 0) uv.x = outwards.x < 0 ? p.z : 1 - p.z;
      if (outwards.y != 0) uv = {p.x, outwards.y > 0 ? p.z : 1 - p.z};
      at.uv[i][0] = static_cast<float>(uv.x), at.uv[i][1] = static_cast<float>(uv.y);
    }
    box.texturing.texcoords[0].push_back(at);
  }
}

void add_closed(Scene& part, const Closed& closed, std::size_t first_disc, Unsettled& unsettled) {
  Cone wall{};
  wall.base = closed.base, wall.apex = closed.apex;
  wall.base_radius = closed.base_radius, wall.apex_radius = closed.apex_radius;
  wall.number = next_number(part);
  part.cones.push_back(wall);
  for (const bool at_apex : {false, true}) {
    unsettled.lids.push_back({closed, at_apex, first_disc + part.discs.size()});
    Disc lid = lid_of(closed, at_apex, 0, 0);
    lid.number = next_number(part);
    part.discs.push_back(lid);
  }
}

void add_plane(Scene& part, const Plane& plane, std::size_t first_disc, Unsettled& unsettled) {
  unsettled.planes.push_back({plane, first_disc + part.discs.size()});
  Disc disc{};
  disc.center = plane.point, disc.normal = plane.normal;
  disc.radius = 1e-300;  // so that only its point counts before it is settled
  disc.number = next_number(part);
  part.discs.push_back(disc);
}

void settle_solids(const Unsettled& unsettled, Scene& scene) {
  if (!unsettled.planes.empty()) settle_planes(unsettled.planes, scene);
  if (unsettled.lids.empty()) return;
  const double seal = kSeal * largest_side(scene.bounds());
  for (const Unsettled::Lid& lid : unsettled.lids) {
    const Disc made = lid_of(lid.of, lid.at_apex, seal, 2 * seal);
    Disc& disc = scene.discs[lid.disc];
    disc.center = made.center, disc.radius = made.radius;
  }
}

const char* fault_of(const Closed& c) {
  Cone wall{};
  wall.base = c.base, wall.apex = c.apex, wall.base_radius = c.base_radius, wall.apex_radius = c.apex_radius;
  return primitives::fault_of(wall);
}

}  // namespace kdray::scene
