// What    What a scene's shape tells of how it is best shown: which way is up, whether it is a room, and from
//         where to see that.
// Shape   Up is y unless a mesh lies on a flat base across z, and on none across y. A room is what is closed
//         around its middle by walls that are seen from inside and lie where its bounds are: 48 rays from the
//         middle tell. (A solid shows them its back, a round thing lies off its bounds.) One that is open on
//         a single side is seen through it, another from within, along its longest free line at the height of
//         eyes.
// Cost    A pass over all triangles; two for rooms. 0.1 s for a million of them on two cores.
#include "accel/prepare/view.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

namespace kdray::prepare {

namespace {

// Of a pixel, where neither the user nor the scene says how many: lights have an area.
constexpr int kSamples = 8;

constexpr std::size_t kRays = 48, kSeen = 16, kGrain = 4096;
constexpr float kMiss = std::numeric_limits<float>::infinity();
template <std::size_t n>
using Rays = std::array<vec3, n>;
using Ways = Rays<kRays>;

// Evenly over the sphere: on a spiral.
Ways ways_all_around() {
  Ways ways;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < kRays; ++i) {
    const double y = 1 - (2 * static_cast<double>(i) + 1) / kRays, r = std::sqrt(1 - y * y);
    const double turn = golden * static_cast<double>(i);
    ways[i] = vec3(dvec3(std::cos(turn) * r, y, std::sin(turn) * r));
  }
  return ways;
}

// Evenly around `up`.
Ways ways_on_the_level(int up) {
  Ways ways;
  for (std::size_t i = 0; i < kRays; ++i) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(i) / kRays;
    ways[i] = vec3(0);
    ways[i][(up + 1) % 3] = static_cast<float>(std::cos(turn));
    ways[i][(up + 2) % 3] = static_cast<float>(std::sin(turn));
  }
  return ways;
}

vec3 corner(const layout::Triangle& t, int i) {
  return {t.v[i][0], t.v[i][1], t.v[i][2]};
}

// Calls `found` with the ray's number, the distance and whether the triangle's front faces it, for each of
// the rays from a point that hits the triangle.
template <std::size_t n, class Found>
void hits_of(const layout::Triangle& t, const vec3& from, const Rays<n>& ways, Found&& found) {
  const vec3 a = corner(t, 0) - from, b = corner(t, 1) - from, c = corner(t, 2) - from;
  const vec3 ab = glm::cross(a, b), bc = glm::cross(b, c), ca = glm::cross(c, a), normal = ab + bc + ca;
  const float height = glm::dot(normal, a);
  for (std::size_t i = 0; i < n; ++i) {
    const float u = glm::dot(ab, ways[i]), v = glm::dot(bc, ways[i]);
    if (u * v < 0) continue;
    const float w = glm::dot(ca, ways[i]);
    if (u * w < 0 || v * w < 0) continue;
    const float slope = glm::dot(normal, ways[i]), distance = height / slope;
    if (distance > 0 && distance < kMiss) found(i, distance, slope < 0);
  }
}

template <class Sum, class Add>
Sum over_triangles(const flatten::FlatScene& flat, const Sum& none, Add&& add) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, flat.triangles.size(), kGrain), none,
      [&](const auto& range, Sum sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) add(sum, flat.triangles.data()[i]);
        return sum;
      },
      [](Sum a, const Sum& b) { return a.grow(b), a; });
}

// What all triangles tell: how much of the box's faces is flat and part of the scene, and what rays from the
// middle meet.
struct Told {
  float flat[3][2] = {};  // [axis][0: lo, 1: hi]; areas
  std::array<bool, kRays> hit = {}, wall = {}, front = {};

  void grow(const Told& o) {
    for (int k = 0; k < 3; ++k)
      for (int side = 0; side < 2; ++side) flat[k][side] += o.flat[k][side];
    for (std::size_t i = 0; i < kRays; ++i) hit[i] |= o.hit[i], wall[i] |= o.wall[i], front[i] |= o.front[i];
  }
};

template <std::size_t n>
struct Distances {
  std::array<float, n> t;
  Distances() { t.fill(kMiss); }
  void grow(const Distances& o) {
    for (std::size_t i = 0; i < n; ++i) t[i] = std::min(t[i], o.t[i]);
  }
};

// Returns how far rays go until they hit something.
template <std::size_t n>
std::array<float, n> free_ways(const flatten::FlatScene& flat, const vec3& from, const Rays<n>& ways) {
  return over_triangles(flat, Distances<n>(),
                        [&](Distances<n>& sum, const layout::Triangle& t) {
                          hits_of(t, from, ways, [&sum](std::size_t i, float distance, bool) {
                            sum.t[i] = std::min(sum.t[i], distance);
                          });
                        })
      .t;
}

// Adds the triangle's area to each face of the box that it lies in, but for a fiftieth.
void add_flat(Told& told, const layout::Triangle& t, const Box& box) {
  constexpr float kNear = 0.02f, kLevel = 0.9f;
  const vec3 normal = glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
  const float length = glm::length(normal);
  for (int k = 0; k < 3; ++k) {
    if (std::abs(normal[k]) < kLevel * length) continue;
    const float near = kNear * box.extent()[k];
    const auto [lo, hi] = std::minmax({t.v[0][k], t.v[1][k], t.v[2][k]});
    if (hi < box.lo[k] + near) told.flat[k][0] += 0.5f * length;
    if (lo > box.hi[k] - near) told.flat[k][1] += 0.5f * length;
  }
}

// Returns how far each ray goes from the box's middle to its surface, and by which axis and side it leaves.
struct Exit {
  float t = kMiss;
  int axis = 0, side = 0;
};
std::array<Exit, kRays> exits_of(const Box& box, const Ways& ways) {
  std::array<Exit, kRays> exits;
  for (std::size_t i = 0; i < kRays; ++i)
    for (int k = 0; k < 3; ++k) {
      const float t = 0.5f * box.extent()[k] / std::abs(ways[i][k]);
      if (t < exits[i].t) exits[i] = {t, k, ways[i][k] < 0 ? 0 : 1};
    }
  return exits;
}

Told told_of(const flatten::FlatScene& flat, const Box& box, const Ways& ways,
             const std::array<Exit, kRays>& exits) {
  constexpr float kBefore = 0.85f, kBehind = 1.15f;  // of the way to the box, where walls lie
  const vec3 middle = box.center();
  return over_triangles(flat, Told(), [&](Told& told, const layout::Triangle& t) {
    add_flat(told, t, box);
    hits_of(t, middle, ways, [&](std::size_t i, float distance, bool is_front) {
      told.hit[i] = true;
      if (distance < kBefore * exits[i].t || distance > kBehind * exits[i].t) return;
      told.wall[i] = true, told.front[i] |= is_front;
    });
  });
}

float share(const Told& told, const Box& box, int axis, int side) {
  const vec3 e = box.extent();
  const float area = e[(axis + 1) % 3] * e[(axis + 2) % 3];
  return area > 0 ? told.flat[axis][side] / area : 0;
}

std::size_t count_of(const std::array<bool, kRays>& of) {
  return static_cast<std::size_t>(std::ranges::count(of, true));
}

bool is_room(const Told& told) {
  const auto hits = static_cast<double>(count_of(told.hit)), walls = static_cast<double>(count_of(told.wall));
  return hits >= 0.75 * kRays && walls >= 0.6 * kRays &&
         static_cast<double>(count_of(told.front)) >= 0.4 * walls;
}

// Returns whether files of this kind say that y is up.
bool says_y(const std::string& name) {
  constexpr std::string_view kNames[] = {".gltf", ".glb", ".json", ".gltf.gz", ".glb.gz", ".json.gz"};
  return std::ranges::any_of(kNames, [&](std::string_view ending) { return name.ends_with(ending); });
}

// What lies on a base across an axis stands on it: what is flat below, by so much more than above. (Round
// things have a twentieth of either.)
void find_up(scene::Studio& studio, const Told& told, const Box& box) {
  constexpr float kBase = 0.12f, kSomeBase = 0.03f;
  const auto base = [&](int axis) {
    return std::max(0.0f, share(told, box, axis, 0) - share(told, box, axis, 1));
  };
  const float y = base(1), z = base(2);
  if (z >= kBase && y <= 0.25f * z)
    studio.up = {0, 0, 1};
  else
    studio.perhaps_on_side = z > kSomeBase && z > 2 * y;
}

// Rooms are lower than they are wide.
void find_up_of_room(scene::Studio& studio, const Box& box) {
  constexpr float kLower = 0.7f;
  const vec3 e = box.extent();
  if (e.z < kLower * e.y && e.z < e.x) studio.up = {0, 0, 1};
}

// Returns the side by which a room is open, as a direction; none where there is none on the level, or
// several.
std::optional<dvec3> open_side_of(const Told& told, const std::array<Exit, kRays>& exits, int up) {
  std::optional<dvec3> open;
  for (int k = 0; k < 3; ++k)
    for (int side = 0; side < 2; ++side) {
      std::size_t n = 0, walls = 0;
      for (std::size_t i = 0; i < kRays; ++i)
        if (exits[i].axis == k && exits[i].side == side) ++n, walls += told.wall[i] ? 1 : 0;
      if (n == 0 || 4 * walls > n) continue;
      if (k == up || open) return std::nullopt;
      open = dvec3(0);
      (*open)[k] = side == 0 ? -1 : 1;
    }
  return open;
}

// Evenly over what a camera on the level sees.
Rays<kSeen> ways_seen(const vec3& forward, int up) {
  vec3 above(0);
  above[up] = 1;
  const vec3 right = glm::cross(forward, above);
  Rays<kSeen> ways;
  for (std::size_t i = 0; i < kSeen; ++i) {
    const auto at = [](std::size_t k) { return 0.3f * (static_cast<float>(k) - 1.5f); };
    ways[i] = glm::normalize(forward + right * at(i % 4) + above * at(i / 4));
  }
  return ways;
}

// Returns where a viewer stands: of the far ends of the longest free lines from the middle, on the level of
// eyes and one in each of eight directions, that from which the most is seen: by the median distance. (A line
// may go through a window.)
scene::Studio::Room stand_in(const flatten::FlatScene& flat, const Box& box, int up,
                             const LocalSpace& space) {
  constexpr float kEyes = 0.45f, kEnd = 0.85f, kLooksDown = 0.04f;
  constexpr std::size_t kSector = kRays / 8;
  vec3 middle = box.center();
  middle[up] = box.lo[up] + kEyes * box.extent()[up];
  const Ways ways = ways_on_the_level(up);
  const std::array<float, kRays> free = free_ways(flat, middle, ways);
  const float most = 0.5f * glm::length(box.extent());
  vec3 from = middle, forward = ways[0];
  float best = 0;
  for (std::size_t first = 0; first < kRays; first += kSector) {
    std::size_t longest = first;
    const auto length = [&](std::size_t i) { return free[i] < most ? free[i] : 0; };
    for (std::size_t i = first; i < first + kSector; ++i)
      if (length(i) > length(longest)) longest = i;
    const vec3 end = middle + kEnd * length(longest) * ways[longest];
    std::array<float, kSeen> seen = free_ways(flat, end, ways_seen(-ways[longest], up));
    std::ranges::nth_element(seen, seen.begin() + kSeen / 2);
    const float depth = std::min(seen[kSeen / 2], 2 * most);
    if (depth > best) best = depth, from = end, forward = -ways[longest];
  }
  vec3 at = from + forward * (0.5f * best);
  at[up] -= kLooksDown * box.extent()[up];
  return {space.world(dvec3(from)), space.world(dvec3(at))};
}

scene::Studio studio_of(const Prepared& p) {
  scene::Studio studio;
  const LocalSpace& space = p.geometry.space;
  const DBox& world = p.settings.framing.box;
  const Box box{vec3(space.local(world.lo)), vec3(space.local(world.hi))};
  const Box& all = p.geometry.bounds;
  studio.own_background = p.settings.sky.kind != scene::SkyKind::none || p.settings.background != vec3(0);
  studio.stands = glm::length(all.extent()) < 1.01f * glm::length(box.extent());
  if (p.flat.triangles.empty() || !p.flat.instances.empty()) return studio;
  const Ways ways = ways_all_around();
  const std::array<Exit, kRays> exits = exits_of(box, ways);
  const Told told = told_of(p.flat, box, ways, exits);
  const bool room = is_room(told), guess = !says_y(p.settings.name);
  if (guess) room ? find_up_of_room(studio, box) : find_up(studio, told, box);
  if (!room) return studio;
  const int up = studio.up.z == 1 ? 2 : 1;
  studio.open_to = open_side_of(told, exits, up);
  if (!studio.open_to) studio.room = stand_in(p.flat, box, up, space);
  return studio;
}

}  // namespace

Prepared in_studio(const Prepared& prepared, bool instead) {
  Prepared made = prepared;
  scene::Framing& framing = made.settings.framing;
  if (framing.box.empty()) return made;
  if (instead && !framing.camera) made.settings.camera = scene::Camera{.at = framing.box.center()};
  if (instead) framing.camera = framing.lights = true;
  if (!framing.camera || !framing.lights) return made;
  framing.studio = studio_of(prepared);
  std::optional<int>& samples = made.settings.settings.samples;
  samples = samples.value_or(kSamples);
  return made;
}

}  // namespace kdray::prepare
