// What    No ray hits the surface that it leaves: reflected, refracted and shadow rays as kdray's shading
//         spawns them, traced by every traversal. And how exact the hits are that they leave from: t and the
//         hit point against exact arithmetic.
// Shape   A triangle or a disc is flat: any hit of a ray's own one is wrong. From outside of a sphere or a
//         cone as well; from inside, the hit must be one of the exact roots of a ray that starts inside,
//         exactly, else it is wrong. Excepted and counted are spheres and cones that are thinner than a few
//         of the float steps at their coordinates.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "layout/tree.layout.h"
#include "stress/exact.h"
#include "stress/random.h"
#include "stress/spawn.h"
#include "stress/table.h"
#include "stress/traced.h"
#include "support/all_kinds.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 60;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kPrimitives = 96;

// A point of a surface, with its normal and how large things are about it.
struct Spot {
  dvec3 point, normal;
  double size;
};

dvec3 tangent_to(const dvec3& n, Random& random) {
  for (;;) {
    const dvec3 t = glm::cross(n, random.direction());
    if (glm::length(t) > 1e-3) return glm::normalize(t);
  }
}
// Steep as often as grazing, down to 1e-6 rad; away from the surface on the side of `n`.
dvec3 leaving(const dvec3& n, Random& random) {
  const double angle = random.bits() & 1 ? random.uniform(0.01, 1.5) : random.log_uniform(1e-6, 0.1);
  return std::cos(angle) * tangent_to(n, random) + std::sin(angle) * n;
}

// ---- Scenes: kPrimitives of one kind each.

scene::Scene with_material() {
  scene::Scene s;
  s.camera = scene::Camera{};
  s.materials.resize(1);
  s.materials[0].reflect = s.materials[0].transmit = vec3(0.5f);
  return s;
}

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
// scene of this size, products of their lengths would be below what floats hold: math/local_space.h.)
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

scene::Scene spheres(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double radius = static_cast<float>(random.log_uniform(1e-4, 1e4));
    const dvec3 center(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    s.spheres.push_back({center, radius, 0, s.primitive_count()});
  }
  return s;
}

// Pointed, truncated, cylinders and cones that are all but flat.
scene::Scene cones(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double r = static_cast<float>(random.log_uniform(1e-4, 1e4)),
                 height = r * random.log_uniform(1e-2, 1e2);
    const double apex = i % 3 == 0 ? 0 : (i % 3 == 1 ? r : static_cast<float>(r * random.uniform()));
    const dvec3 base(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    const dvec3 axis = random.below(4) == 0 ? dvec3(0, 0, 1) : random.direction();
    const dvec3 top(vec3(base + height * axis));
    if (glm::length(top - base) < 0.5 * height) continue;  // drowned by rounding
    s.cones.push_back({base, top, r, apex, 0, s.primitive_count()});
  }
  return s;
}

scene::Scene discs(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double radius = static_cast<float>(random.log_uniform(1e-4, 1e4));
    const dvec3 center(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    dvec3 normal = random.direction();
    if (i % 4 == 0) normal = dvec3(0), normal[static_cast<int>(random.below(3))] = random.sign();
    s.discs.push_back({center, normal, radius, 0, s.primitive_count()});
  }
  return s;
}

// From one whose hole is all but closed to thin rings.
scene::Scene tori(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double major = static_cast<float>(random.log_uniform(1e-4, 1e4));
    const double minor = i % 3 == 0 ? 0.999 * major : major / random.log_uniform(1.1, 1e3);
    const dvec3 center(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    dvec3 axis = random.direction();
    if (i % 4 == 0) axis = dvec3(0), axis[static_cast<int>(random.below(3))] = random.sign();
    s.tori.push_back({center, axis, major, minor, 0, s.primitive_count()});
  }
  return s;
}

// ---- What the kinds differ in. A kind that lacks one of these does not compile.

// The scenes of a kind; `share` of all rays.
struct Family {
  const char* name;
  scene::Scene (*make)(std::uint64_t seed);
  double share;
};
std::vector<Family> families_of(primitives::TriangleKind) {
  return {{"triangles, coordinates 1e-8 to 1e8", triangles_of_any_coordinates, 0.3},
          {"triangles, sizes 1e-14 to 1e9", triangles_of_any_size, 0.2},
          {"triangles across the axes", triangles_across_axes, 0.1}};
}
std::vector<Family> families_of(primitives::SphereKind) {
  return {{"spheres, radius 1e-4 to 1e4, to 1e6 off", spheres, 0.15}};
}
std::vector<Family> families_of(primitives::ConeKind) {
  return {{"cones, radius 1e-4 to 1e4, to 1e6 off", cones, 0.15}};
}
std::vector<Family> families_of(primitives::DiscKind) {
  return {{"discs, radius 1e-4 to 1e4, to 1e6 off", discs, 0.1}};
}

std::vector<Family> families_of(primitives::TorusKind) {
  return {{"tori, radius 1e-4 to 1e4, to 1e6 off", tori, 0.03}};
}

dvec3 point3(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

Spot spot_on(const layout::Triangle& t, Random& random) {
  const dvec3 a = point3(t.v[0]), e1 = point3(t.v[1]) - a, e2 = point3(t.v[2]) - a, w = random.weights();
  return {a + w.y * e1 + w.z * e2, glm::normalize(glm::cross(e1, e2)),
          std::max(glm::length(e1), glm::length(e2))};
}
Spot spot_on(const layout::Sphere& s, Random& random) {
  const dvec3 n = random.direction();
  return {point3(s.center) + static_cast<double>(s.radius) * n, n, s.radius};
}
Spot spot_on(const layout::Cone& c, Random& random) {
  const dvec3 axis = point3(c.axis), radial = tangent_to(axis, random);
  const double slope = c.slope, s = random.uniform() * c.height, r = c.base_radius + slope * s;
  return {point3(c.base) + s * axis + r * radial, glm::normalize(radial - slope * axis),
          std::max<double>(r, 1e-3 * c.height)};
}
Spot spot_on(const layout::Disc& d, Random& random) {
  const dvec3 n = glm::normalize(point3(d.normal));
  return {point3(d.center) + d.radius * std::sqrt(random.uniform()) * tangent_to(n, random), n, d.radius};
}

Spot spot_on(const layout::Torus& t, Random& random) {
  const dvec3 axis = glm::normalize(point3(t.axis)), out = tangent_to(axis, random);
  const double angle = 6.283185307179586 * random.uniform();
  const dvec3 n = std::cos(angle) * out + std::sin(angle) * axis;
  return {
      point3(t.center) + static_cast<double>(t.major_radius) * out + static_cast<double>(t.minor_radius) * n,
      n, t.minor_radius};
}

std::string described(const layout::Triangle& t) {
  std::string all = "triangle";
  for (const auto& v : t.v)
    for (const float c : v) all += fmt::format(" {:a}", c);
  return all;
}
std::string described(const layout::Sphere& s) {
  return fmt::format("sphere {:a} {:a} {:a} radius {:a}", s.center[0], s.center[1], s.center[2], s.radius);
}
std::string described(const layout::Cone& c) {
  return fmt::format("cone {:a} {:a} {:a} axis {:a} {:a} {:a} base radius {:a} height {:a} slope {:a}",
                     c.base[0], c.base[1], c.base[2], c.axis[0], c.axis[1], c.axis[2], c.base_radius,
                     c.height, c.slope);
}
std::string described(const layout::Disc& d) {
  return fmt::format("disc {:a} {:a} {:a} normal {:a} {:a} {:a} radius {:a}", d.center[0], d.center[1],
                     d.center[2], d.normal[0], d.normal[1], d.normal[2], d.radius);
}

std::string described(const layout::Torus& t) {
  return fmt::format("torus {:a} {:a} {:a} axis {:a} {:a} {:a} radii {:a} {:a}", t.center[0], t.center[1],
                     t.center[2], t.axis[0], t.axis[1], t.axis[2], t.major_radius, t.minor_radius);
}

double largest_coordinate(const layout::Triangle& t) {
  double m = 0;
  for (const auto& v : t.v)
    for (const float c : v) m = std::max<double>(m, std::abs(c));
  return m;
}
double largest_coordinate(const layout::Sphere& s) {
  const dvec3 c = glm::abs(point3(s.center));
  return std::max({c.x, c.y, c.z}) + s.radius;
}
double largest_coordinate(const layout::Cone& c) {
  const dvec3 b = glm::abs(point3(c.base));
  return std::max({b.x, b.y, b.z}) + c.height + c.base_radius;
}
double largest_coordinate(const layout::Disc& d) {
  const dvec3 c = glm::abs(point3(d.center));
  return std::max({c.x, c.y, c.z}) + d.radius;
}

double largest_coordinate(const layout::Torus& t) {
  const dvec3 c = glm::abs(point3(t.center));
  return std::max({c.x, c.y, c.z}) + t.major_radius + t.minor_radius;
}

enum class Verdict { right, wrong, excepted };

struct Departure {
  std::uint32_t primitive;  // that it leaves, by number
  bool inwards;             // to the inside of a sphere or cone
  bool to_light;
  float radius;  // of the surface where it leaves it
  float step;    // how far off the surface its origin was moved, about
  float blur;    // by how much at most in any direction
};

// A light that is nearer to the surface than rounding can tell is lit or not as rounding will have it.
template <class Surface>
bool ends_at_the_surface(const Surface& surface, const Ray& ray, const Departure& departure) {
  if (!departure.to_light) return false;
  Exact3 o = exactly(ray.origin), d = exactly(ray.direction);
  const double reach = glm::length(point3(ray.direction));
  const Exact3 end{Exact(o.x + d.x), Exact(o.y + d.y), Exact(o.z + d.z)};
  return std::abs(distance(end, surface)) <= 4 * departure.step + 0x1p-21 * reach;
}

// Whether a hit of the ray's own surface may be.
template <class Flat>
Verdict judge_flat(const Flat& surface, const Ray& ray, const Departure& departure) {
  return ends_at_the_surface(surface, ray, departure) ? Verdict::excepted : Verdict::wrong;
}
Verdict judge(const layout::Triangle& surface, const Ray& ray, const Hit&, const Departure& departure) {
  return judge_flat(surface, ray, departure);
}
Verdict judge(const layout::Disc& surface, const Ray& ray, const Hit&, const Departure& departure) {
  return judge_flat(surface, ray, departure);
}
// Whether a point of the surface that is moved inwards by the step may come out again: on the other side, or
// across, where the blur is longer than half of the chord at that depth.
bool may_come_out_again(const Departure& d) {
  return 4 * d.step > d.radius || d.blur * d.blur > d.step * (2 * d.radius - d.step);
}

// From inside: the hit is what is behind the ray's way, not what it left. (Grazing, rounding moves it far;
// what was left lies behind the origin.)
template <class Curved>
bool is_on_the_way(const Exact3& o, const Exact3& d, const Curved& surface, float t_found) {
  return std::ranges::any_of(roots(o, d, surface), [t_found](const Exact& root) {
    const double t = root.get_d();
    return t > 0 && std::abs(t_found - t) <= 0.5 * t;
  });
}

// A ray that grazes a cone may meet it next where the exact one is just past an end.
bool is_at_an_end(const Exact3& o, const Exact3& d, const layout::Cone& cone, float t_found) {
  return std::ranges::any_of(roots_past_the_ends(o, d, cone, 0.02), [t_found](const Exact& root) {
    return root > 0 && std::abs(t_found - root.get_d()) <= 0.5 * root.get_d();
  });
}
bool is_at_an_end(const Exact3&, const Exact3&, const layout::Sphere&, float) {
  return false;
}

// It may meet itself again from outside as well, across its hole or along its inner side.
Verdict judge(const layout::Torus& surface, const Ray& ray, const Hit& hit, const Departure& departure) {
  if (ends_at_the_surface(surface, ray, departure)) return Verdict::excepted;
  const Exact3 o = exactly(ray.origin), d = exactly(ray.direction);
  if (departure.inwards != (distance(o, surface) < 0))
    return may_come_out_again(departure) ? Verdict::excepted : Verdict::wrong;
  if (is_on_the_way(o, d, surface, hit.t)) return Verdict::right;
  return 64 * departure.step > departure.radius ? Verdict::excepted : Verdict::wrong;
}

template <class Curved>
Verdict judge(const Curved& surface, const Ray& ray, const Hit& hit, const Departure& departure) {
  if (ends_at_the_surface(surface, ray, departure)) return Verdict::excepted;
  const Exact3 o = exactly(ray.origin), d = exactly(ray.direction);
  // To the outside of a tip that is thinner than the blur, a normal may be so far off that even the exact ray
  // meets it again.
  if (!departure.inwards)
    return 4 * departure.step > departure.radius && is_on_the_way(o, d, surface, hit.t) ? Verdict::excepted
                                                                                        : Verdict::wrong;
  if (distance(o, surface) > 0) return may_come_out_again(departure) ? Verdict::excepted : Verdict::wrong;
  if (is_on_the_way(o, d, surface, hit.t)) return Verdict::right;
  if (is_at_an_end(o, d, surface, hit.t)) return Verdict::excepted;
  return 64 * departure.step > departure.radius ? Verdict::excepted : Verdict::wrong;
}

// The scene's own space is the world that its rays are made and traced in.
PreparedScene in_local_space(const scene::Scene& model) {
  prepare::Prepared prepared = prepare::prepare(model, {});
  prepared.geometry.space = {};
  return PreparedScene(std::move(prepared));
}

// ---- One scene's rays

template <class Kind>
class Case {
  using Surface = typename Kind::Layout;

 public:
  Case(const scene::Scene& model, std::uint64_t seed)
      : prepared_(in_local_space(model)), renderer_(prepared_), spawner_(prepared_.prepared()), seed_(seed) {
    for (std::uint32_t i = 0; i < primitives().size(); ++i) index_of_[primitives()[i].number] = i;
  }

  // n rays at the scene's primitives, and what comes of them with every walk.
  void trace(std::size_t n, Tally& tally, Errors& errors, std::uint64_t exact_samples) {
    const std::vector<ToSpawn> hits = hits_of(n, kWalks[seed_ % kWalks.size()].traversal);
    const std::vector<Spawned> spawned = spawner_.spawn(hits);
    for (std::size_t i = 0; i < hits.size() && i < exact_samples; ++i) measure(hits[i], spawned[i], errors);
    collect(hits, spawned);
    const auto make = [&](std::uint64_t i) { return rays_[i]; };
    const auto wrong = [&](std::uint64_t i, const Ray& ray, const Hit& hit) {
      return verdict(i, ray, hit) == Verdict::wrong;
    };
    trace_all(renderer_, 0, rays_.size(), make, wrong, tally);
    count_exceptions(tally);
  }

 private:
  const auto& primitives() const { return Kind::of(prepared_.prepared().flat); }

  ToSpawn aim(std::uint64_t number, float* t_min) const {
    Random random(seed_, number);
    const Spot spot = spot_on(primitives()[random.below(primitives().size())], random);
    const dvec3 normal = random.sign() * spot.normal, d = leaving(normal, random);
    const double far = spot.size * random.log_uniform(1e-2, 1e2);
    const dvec3 light = spot.point + spot.size * random.log_uniform(1e-3, 1e3) * leaving(normal, random);
    const vec3 origin(spot.point + far * d), direction(-d), to(light);
    ToSpawn ray{{origin.x, origin.y, origin.z},
                {direction.x, direction.y, direction.z},
                0,
                KDRAY_REF_MISS,
                0,
                0,
                {to.x, to.y, to.z},
                static_cast<float>(random.log_uniform(0.3, 3))};
    *t_min = static_cast<float>(0.5 * far);
    return ray;
  }

  std::vector<ToSpawn> hits_of(std::size_t n, Traversal walk) {
    std::vector<ToSpawn> aimed(n);
    const std::vector<Ray> rays = make_rays(0, n, [&](std::uint64_t i) {
      float t_min = 0;
      const ToSpawn& a = aimed[i] = aim(i, &t_min);
      return Ray{{a.origin[0], a.origin[1], a.origin[2]},
                 t_min,
                 {a.direction[0], a.direction[1], a.direction[2]},
                 kInfinity};
    });
    const std::vector<Hit> hits = renderer_.trace(rays, false, 1, walk);
    std::vector<ToSpawn> met;
    met.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (hits[i].primitive < 0) continue;
      ToSpawn& h = aimed[i];
      h.t = hits[i].t, h.u = hits[i].u, h.v = hits[i].v;
      h.ref =
          Kind::kNumber << KDRAY_REF_KIND_SHIFT | index_of_.at(static_cast<std::uint32_t>(hits[i].primitive));
      met.push_back(h);
    }
    return met;
  }

  const Surface& primitive_of(std::uint32_t ref) const { return primitives()[ref & KDRAY_REF_INDEX_MASK]; }

  static float radius_at(const layout::Triangle&, const Spawned&) { return kInfinity; }
  static float radius_at(const layout::Disc&, const Spawned&) { return kInfinity; }
  static float radius_at(const layout::Sphere& s, const Spawned&) { return s.radius; }
  // What is thin of a torus is its tube, or its hole.
  static float radius_at(const layout::Torus& t, const Spawned&) {
    return std::min(t.minor_radius, t.major_radius - t.minor_radius);
  }
  static float radius_at(const layout::Cone& c, const Spawned& s) {
    const double along = glm::dot(point3(s.point) - point3(c.base), point3(c.axis));
    return static_cast<float>(c.base_radius + c.slope * std::clamp<double>(along, 0, c.height));
  }

  void collect(const std::vector<ToSpawn>& hits, const std::vector<Spawned>& spawned) {
    rays_.clear(), departures_.clear();
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const Spawned& s = spawned[i];
      const Surface& primitive = primitive_of(hits[i].ref);
      const bool inside = s.flags & kFromInside;
      const float step = static_cast<float>(glm::dot(glm::abs(point3(s.normal)), point3(s.point_error)));
      const float blur = static_cast<float>(glm::length(point3(s.point_error)));
      const auto put = [&](const float(&o)[3], const float(&d)[3], bool inwards, bool to_light) {
        if (!std::isfinite(d[0] + d[1] + d[2]) || (d[0] == 0 && d[1] == 0 && d[2] == 0)) return;
        rays_.push_back({{o[0], o[1], o[2]}, 0, {d[0], d[1], d[2]}, to_light ? 1 - 0x1p-19f : kInfinity});
        departures_.push_back({primitive.number, inwards, to_light, radius_at(primitive, s), step, blur});
      };
      put(s.above, s.reflected, inside, false);
      if (s.flags & kRefracts) put(s.below, s.refracted, !inside, false);
      if (s.flags & kLit) put(s.above, s.to_light, inside, true);
    }
  }

  Verdict verdict(std::size_t i, const Ray& ray, const Hit& hit) const {
    const Departure& departure = departures_[i];
    if (hit.primitive < 0 || static_cast<std::uint32_t>(hit.primitive) != departure.primitive)
      return Verdict::right;
    return judge(primitives()[index_of_.at(departure.primitive)], ray, hit, departure);
  }

  // The first few in words.
  void explain(const std::vector<Hit>& hits) const {
    int n = 0;
    for (std::size_t i = 0; i < hits.size() && n < 3; ++i) {
      if (verdict(i, rays_[i], hits[i]) != Verdict::wrong) continue;
      ++n;
      const Departure& departure = departures_[i];
      const Surface& primitive = primitives()[index_of_.at(departure.primitive)];
      const Exact3 o = exactly(rays_[i].origin), d = exactly(rays_[i].direction);
      std::string all;
      for (const Exact& root : roots(o, d, primitive)) all += ' ' + std::to_string(root.get_d());
      ADD_FAILURE() << "seed " << seed_ << ", " << in_words(rays_[i]) << in_words(hits[i])
                    << (departure.inwards ? "; inwards" : "; outwards")
                    << (departure.to_light ? " to a light" : "") << "; starts " << distance(o, primitive)
                    << " off its surface, moved by " << departure.step << ", radius " << departure.radius
                    << "; exact roots" << all << "; t " << hits[i].t << "; " << described(primitive);
    }
  }

  void count_exceptions(Tally& tally) {
    const std::vector<Hit> hits = renderer_.trace(rays_, false, 1, Traversal::binary);
    if (tally.wrong() != 0 && !explained_) explain(hits), explained_ = true;
    const std::uint64_t n = count(
        rays_.size(), [&](std::size_t i) { return verdict(i, rays_[i], hits[i]) == Verdict::excepted; });
    for (std::size_t w = 0; w < kWalks.size(); ++w) tally.row(w).exceptions += n;
  }

  // The hit that was found, against exact arithmetic.
  void measure(const ToSpawn& h, const Spawned& s, Errors& errors) const {
    const Surface& primitive = primitive_of(h.ref);
    ASSERT_TRUE(std::isfinite(s.point[0] + s.point[1] + s.point[2] + s.normal[0] + s.normal[1] + s.normal[2]))
        << "seed " << seed_ << ", ray "
        << in_words(Ray{{h.origin[0], h.origin[1], h.origin[2]},
                        0,
                        {h.direction[0], h.direction[1], h.direction[2]},
                        h.t});
    const std::vector<Exact> all = roots(exactly(h.origin), exactly(h.direction), primitive);
    double t_error = kInfinity, in_play = kInfinity;
    for (const Exact& t : all) {
      t_error = std::min(t_error, ulps(h.t, t, t.get_d()));
      in_play = std::min(in_play, ulps(h.t, t, std::max(t.get_d(), largest_coordinate(primitive))));
    }
    const double cosine = std::abs(glm::dot(point3(s.normal), point3(h.direction)));
    const double off = std::abs(distance(exactly(s.point), primitive));
    ASSERT_TRUE(std::isfinite(off));
    ++errors.samples;
    if (!all.empty()) errors.t_ulps = std::max(errors.t_ulps, t_error);
    if (!all.empty() && cosine > 0.7) errors.t_facing_ulps = std::max(errors.t_facing_ulps, in_play);
    errors.point_ulps = std::max(errors.point_ulps, off / ulp(largest_coordinate(primitive)));
    errors.share_of_bound =
        std::max(errors.share_of_bound, off / glm::dot(glm::abs(point3(s.normal)), point3(s.point_error)));
  }

  PreparedScene prepared_;
  Renderer renderer_;
  Spawner spawner_;
  std::uint64_t seed_;
  std::map<std::uint32_t, std::uint32_t> index_of_;  // of a primitive by its number
  std::vector<Ray> rays_;
  std::vector<Departure> departures_;
  bool explained_ = false;
};

template <class Kind>
class SelfHitsOf : public testing::Test {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
    set_precision();
  }

  static void expect_none(const Family& family) {
    Tally tally("re-hits", family.name);
    Errors errors;
    errors.family = family.name;
    const std::uint64_t wanted = rays_to_trace(family.share / 5);
    for (std::uint64_t scene = 0; tally.row(0).rays < wanted; ++scene) {
      Case<Kind> one(family.make(kSeed + scene), kSeed + scene);
      one.trace(std::min<std::uint64_t>(wanted / 12 + 256, 1 << 17), tally, errors, is_full() ? 2000 : 500);
    }
    tally.publish();
    add(errors);
    EXPECT_EQ(tally.wrong(), 0) << "seed " << kSeed << ", " << tally.first_wrong;
    EXPECT_EQ(tally.differing, 0) << "hits that differ between the traversals: " << tally.first_differing;
    EXPECT_LT(errors.share_of_bound, 1)
        << "a hit point is farther off its surface than the bound on its error";
  }
};
TYPED_TEST_SUITE(SelfHitsOf, test::AllKinds, test::KindNames);

TYPED_TEST(SelfHitsOf, ThereAreNone) {
  for (const Family& family : families_of(TypeParam())) {
    SCOPED_TRACE(family.name);
    TestFixture::expect_none(family);
  }
}

}  // namespace
}  // namespace kdray::stress
