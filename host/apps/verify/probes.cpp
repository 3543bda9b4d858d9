#include "apps/verify/probes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>

#include "apps/verify/aims.h"
#include "apps/verify/edges.h"
#include "apps/verify/exact.h"
#include "apps/verify/tracer.h"

namespace kdray::verify {

namespace {

constexpr std::uint64_t kSeed = 20090501;
constexpr std::size_t kRound = 1 << 16, kRaysPerOrigin = 256, kMostOrigins = 4096;
constexpr std::size_t kWitnesses = 100;  // of each defect
constexpr Traversal kOtherWalks[] = {Traversal::wide, Traversal::packet, Traversal::batch,
                                     Traversal::automatic};

double reach_of(const Box& b) {
  if (b.empty()) return 0;
  const vec3 m = glm::max(glm::abs(b.lo), glm::abs(b.hi));
  return std::max({m.x, m.y, m.z});
}

vec3 at(const Ray& ray, double t) {
  const Line line = line_of(ray);
  return vec3(line.origin + (std::isfinite(t) ? t : 1.0) * line.direction);
}

dvec3 point(const float (&p)[3]) {
  return {p[0], p[1], p[2]};
}

bool same(const Hit& a, const Hit& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

bool is_hit(const Hit& h) {
  return h.primitive >= 0;
}

// Returns the place of each primitive in Geometry, by its number: triangles, then the shapes, kind by kind.
std::vector<std::uint32_t> places_by_number(const Subject& s) {
  std::vector<std::uint32_t> places(s.scene.primitive_count());
  std::uint32_t place = 0;
  for (const auto& t : s.geometry.triangles) places[t.number] = place++;
  primitives::for_each_shape([&](auto kind) {
    const auto& sources = decltype(kind)::of(s.scene);
    for (const auto& shape : decltype(kind)::of(s.geometry)) places[sources[shape.source].number] = place++;
  });
  return places;
}

int side_of(const Line& line, const scene::TriangleGeometry& t) {
  return side_of_plane(line, dvec3(scene::vertex(t, 0)), dvec3(scene::vertex(t, 1)),
                       dvec3(scene::vertex(t, 2)));
}

enum class Leaves { mirrored, scattered, grazing, through };

// A ray that leaves a hit.
struct Leaving {
  std::size_t parent;  // of the round's hits
  Leaves how;
  dvec3 side;  // the normal on the side of the surface where it has to be
};

struct Blamed {
  std::size_t i;  // of the ray
  Witness witness;
};

class Prober {
 public:
  Prober(const Subject& s, Tracer& tracer)
      : s_(s),
        tracer_(tracer),
        reach_(reach_of(s.geometry.bounds)),
        insides_(s.mesh, s.boxes, s.topology),
        aims_(s, insides_, clearance(), kSeed),
        random_(kSeed + 1),
        place_of_(places_by_number(s)) {}

  Probes run(std::uint64_t n_rays, const std::function<void(double)>& progress) {
    if (s_.geometry.size() == 0) return {};
    find_origins(n_rays);
    for (std::uint64_t done = 0; done < n_rays; done += kRound) {
      if (progress) progress(static_cast<double>(done) / static_cast<double>(n_rays));
      round(static_cast<std::size_t>(std::min<std::uint64_t>(kRound, n_rays - done)));
    }
    return std::move(out_);
  }

 private:
  // Where a ray of kdray's may go astray is within 2^-20 of the scene (docs/design/numerics.md); what is
  // farther from a surface is surely on its side.
  double clearance() const { return 0x1p-17 * reach_; }

  void find_origins(std::uint64_t n_rays) {
    const std::uint64_t wanted = std::clamp<std::uint64_t>(n_rays / 2 / kRaysPerOrigin, 16, kMostOrigins);
    origins_ = aims_.find_origins(static_cast<std::size_t>(wanted));
    std::set<std::uint32_t> components;
    for (const InsideOrigin& origin : origins_) components.insert(origin.component);
    out_.origins = origins_.size();
    out_.components = components.size();
  }

  // Traces n rays, and those that leave their hits.
  void round(std::size_t n) {
    std::vector<Aimed> aimed(n);
    std::vector<Ray> rays(n);
    for (std::size_t i = 0; i < n; ++i) {
      const bool inside = !origins_.empty() && i % 2 == 0;
      aimed[i] = inside ? aims_.from_inside(origins_[next_origin_++ / kRaysPerOrigin % origins_.size()])
                        : aims_.from_outside();
      rays[i] = aimed[i].ray;
      ++(inside ? out_.from_inside : out_.from_outside);
    }
    const std::vector<Hit> hits = trace(rays);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      if (aimed[i].component != kNowhere) {
        check_inside(aimed[i], hits[i], i);
      } else {
        check_target(aimed[i], hits[i], i);
      }
      check_before(rays[i], hits[i], i);
    });
    settle();
    leave(rays, hits);
  }

  // Traces by the binary tree; the other walks must agree.
  std::vector<Hit> trace(const std::vector<Ray>& rays) {
    std::vector<Hit> hits = tracer_.closest(rays, Traversal::binary);
    for (const Traversal walk : kOtherWalks) {
      const std::vector<Hit> others = tracer_.closest(rays, walk);
      for (std::size_t i = 0; i < rays.size(); ++i)
        if (!same(hits[i], others[i])) blame(Defect::disagreement, rays[i], hits[i], i);
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit& h = hits[i];
      if (std::isnan(h.t) || (is_hit(h) && !(std::isfinite(h.t) && std::isfinite(h.u) && std::isfinite(h.v))))
        blame(Defect::not_a_number, rays[i], h, i);
    }
    settle();
    return hits;
  }

  // Until its first hit, a ray from inside is inside.
  void check_inside(const Aimed& aimed, const Hit& hit, std::size_t i) {
    const auto component = static_cast<std::uint32_t>(aimed.component);
    if (!is_hit(hit)) return blame(Defect::leak, aimed.ray, hit, i);
    if (leaves(aimed.ray, hit, component)) return;
    const Line line = line_of(aimed.ray);
    bool sure = false;
    for (const double share : {1 - 0x1p-12, 1 - 0x1p-8, 1 - 0x1p-5}) {
      const Side side =
          insides_.side_of(line.origin + share * hit.t * line.direction, component, clearance());
      if (side == Side::outside) return blame(Defect::leak, aimed.ray, hit, i);
      sure |= side == Side::inside;
    }
    if (!sure) count(&Probes::in_doubt);
  }

  // Returns whether the hit is on the component and the ray goes out through it. (Only a closed component has
  // a way out that is known.)
  bool leaves(const Ray& ray, const Hit& hit, std::uint32_t component) const {
    const std::optional<std::uint32_t> face = face_of(hit);
    if (!face || s_.topology.component_of[*face] != component) return false;
    const Component& c = s_.topology.components[component];
    return c.closed() && glm::dot(s_.mesh.normal(*face), line_of(ray).direction) * c.volume > 0;
  }

  std::optional<std::uint32_t> face_of(const Hit& hit) const {
    if (!is_hit(hit)) return {};
    const std::uint32_t place = place_of_[static_cast<std::size_t>(hit.primitive)];
    if (place >= s_.geometry.triangles.size()) return {};
    return place;
  }

  // Nothing is hit behind what was surely hit.
  void check_target(const Aimed& aimed, const Hit& hit, std::size_t i) {
    const Line line = line_of(aimed.ray);
    const double margin = 0x1p-18 * (reach_ + glm::length(line.origin));
    const std::optional<double> t = target_distance(line, static_cast<std::size_t>(aimed.target), margin);
    const double tolerance = 16 * margin / glm::length(line.direction);
    if (!t || *t < tolerance) return;
    if (!is_hit(hit) || hit.t > *t + tolerance + 0x1p-18 * *t) blame(Defect::lost_hit, aimed.ray, hit, i);
  }

  std::optional<double> target_distance(const Line& line, std::size_t target, double margin) const {
    const scene::Geometry& g = s_.geometry;
    if (target < g.triangles.size()) {
      const scene::TriangleGeometry& v = g.triangles[target];
      const dvec3 a(scene::vertex(v, 0)), b(scene::vertex(v, 1)), c(scene::vertex(v, 2));
      // The distance along the ray is off by what the plane is, over the sine of their angle.
      const dvec3 n = glm::cross(b - a, c - a);
      if (std::abs(glm::dot(n, line.direction)) < 0x1p-4 * glm::length(n) * glm::length(line.direction))
        return {};
      return sure_hit(line, a, b, c, margin);
    }
    std::optional<double> t;
    scene::visit_primitive(g, target, [&](auto kind, std::uint32_t index) {
      if constexpr (decltype(kind)::kIsShape) t = sure_target(line, decltype(kind)::of(g)[index], margin);
    });
    return t;
  }

  // A hit's plane has the ray's origin before it.
  void check_before(const Ray& ray, const Hit& hit, std::size_t i) {
    const std::optional<std::uint32_t> face = face_of(hit);
    if (!face) return;
    if (side_of(line_of(ray), s_.geometry.triangles[*face]) < 0) blame(Defect::behind, ray, hit, i);
  }

  // ---- Rays that leave hits.

  void leave(const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
    std::vector<Ray> struck;
    std::vector<Hit> strikes;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!is_hit(hits[i])) continue;
      struck.push_back(rays[i]), strikes.push_back(hits[i]);
    }
    const std::vector<layout::Departure> departures = tracer_.departures(struck, strikes);
    std::vector<Ray> leaving;
    std::vector<Leaving> how;
    for (std::size_t i = 0; i < struck.size(); ++i)
      add_leaving(struck[i], strikes[i], departures[i], i, leaving, how);
    out_.leaving += leaving.size();
    const std::vector<Hit> found = trace(leaving);
    tbb::parallel_for(std::size_t{0}, leaving.size(), [&](std::size_t i) {
      const std::size_t parent = how[i].parent;
      check_self(leaving[i], how[i], strikes[parent], found[i], i);
      check_before(leaving[i], found[i], i);
      if (how[i].how == Leaves::through) check_twice(strikes[parent], leaving[i], found[i]);
    });
    settle();
  }

  void add_leaving(const Ray& ray, const Hit& hit, const layout::Departure& d, std::size_t parent,
                   std::vector<Ray>& leaving, std::vector<Leaving>& how) {
    const dvec3 n = point(d.normal), front = point(d.front), back = point(d.back);
    if (!is_finite(n) || !is_finite(front) || !is_finite(back))
      return blame(Defect::not_a_number, ray, hit, parent);
    const dvec3 in = glm::normalize(line_of(ray).direction);
    const auto kind = static_cast<Leaves>(random_.below(3));
    dvec3 out = in - 2 * glm::dot(in, n) * n;
    if (kind != Leaves::mirrored) {
      out = random_.direction();
      if (glm::dot(out, n) < 0) out = -out;
    }
    if (kind == Leaves::grazing) {
      const double slope = std::pow(10, random_.between(-6, -1));
      out = glm::normalize(out - glm::dot(out, n) * n) + slope * n;
    }
    add_ray(d.front, out, {parent, kind, n}, leaving, how);
    add_ray(d.back, in, {parent, Leaves::through, -n}, leaving, how);
  }

  static void add_ray(const float (&origin)[3], const dvec3& direction, const Leaving& leaving,
                      std::vector<Ray>& rays, std::vector<Leaving>& how) {
    const vec3 d(direction);
    if (!is_finite(direction) || d == vec3(0.0f)) return;
    rays.push_back(
        {{origin[0], origin[1], origin[2]}, 0, {d.x, d.y, d.z}, std::numeric_limits<float>::infinity()});
    how.push_back(leaving);
  }

  // A ray that leaves a triangle never meets it again. For shapes, meets_again() says what is certain.
  void check_self(const Ray& ray, const Leaving& how, const Hit& from, const Hit& found, std::size_t i) {
    if (!is_hit(found) || found.primitive != from.primitive) return;
    const Line line = line_of(ray);
    const std::size_t place = place_of_[static_cast<std::size_t>(from.primitive)];
    const scene::Geometry& g = s_.geometry;
    if (place < g.triangles.size()) {
      // A direction of our own may lie on the wrong side of the plane, by the rounding of the normal it was
      // made from.
      const bool towards = side_of(line, g.triangles[place]) > 0;
      if ((how.how == Leaves::scattered || how.how == Leaves::grazing) && towards) return;
      return blame(Defect::self_hit, ray, found, i);
    }
    bool again = false;
    scene::visit_primitive(g, place, [&](auto kind, std::uint32_t index) {
      if constexpr (decltype(kind)::kIsShape)
        again = meets_again(line, decltype(kind)::of(g)[index], found.t, how.side);
    });
    if (again) blame(Defect::self_hit, ray, found, i);
  }

  // A closed component is not entered twice, nor left twice, in one place.
  void check_twice(const Hit& first, const Ray& through, const Hit& second) {
    const std::optional<std::uint32_t> a = face_of(first), b = face_of(second);
    if (!a || !b || *a == *b || s_.mesh.zero_area[*a] != 0 || s_.mesh.zero_area[*b] != 0) return;
    const Line line = line_of(through);
    const double gap = second.t * glm::length(line.direction);
    if (gap > clearance()) return;
    if (overlap(s_.mesh, *a, *b)) return;
    const std::uint32_t component = s_.topology.component_of[*a];
    const Component& c = s_.topology.components[component];
    if (s_.topology.component_of[*b] != component || !c.closed()) return;
    const bool out_a = glm::dot(s_.mesh.normal(*a), line.direction) > 0;
    const bool out_b = glm::dot(s_.mesh.normal(*b), line.direction) > 0;
    if (out_a != out_b) return;
    // The surface is really crossed once where the two hits cross it twice.
    const dvec3 step = 0x1p-11 * reach_ / glm::length(line.direction) * line.direction;
    const Side before = insides_.side_of(line.origin - step, component, clearance());
    const Side behind = insides_.side_of(line.origin + step, component, clearance());
    if (before == Side::unsure || behind == Side::unsure || before == behind) return;
    count(&Probes::crossed_twice);
  }

  // ---- What was found.

  void blame(Defect defect, const Ray& ray, const Hit& hit, std::size_t i) {
    const std::lock_guard lock(mutex_);
    blamed_.push_back({i, {defect, at(ray, hit.t), hit.primitive, ray}});
  }

  // Takes over what the last loop found, in the order of its rays.
  void settle() {
    const auto key = [](const Blamed& b) { return std::pair(b.i, b.witness.defect); };
    std::sort(blamed_.begin(), blamed_.end(),
              [&](const Blamed& a, const Blamed& b) { return key(a) < key(b); });
    for (const Blamed& b : blamed_) {
      std::uint64_t& n = out_.count[static_cast<std::size_t>(b.witness.defect)];
      if (n++ < kWitnesses) out_.witnesses.push_back(b.witness);
    }
    blamed_.clear();
  }

  void count(std::uint64_t Probes::*what) {
    const std::lock_guard lock(mutex_);
    ++(out_.*what);
  }

  const Subject& s_;
  Tracer& tracer_;
  const double reach_;
  const Insides insides_;
  Aims aims_;
  Random random_;
  const std::vector<std::uint32_t> place_of_;
  std::vector<InsideOrigin> origins_;
  std::uint64_t next_origin_ = 0;
  std::mutex mutex_;
  std::vector<Blamed> blamed_;
  Probes out_;
};

}  // namespace

std::uint64_t Probes::defects() const {
  return std::accumulate(count.begin(), count.end(), std::uint64_t{0});
}

Probes probe(const Subject& subject, Tracer& tracer, std::uint64_t n_rays,
             const std::function<void(double)>& progress) {
  return Prober(subject, tracer).run(n_rays, progress);
}

}  // namespace kdray::verify
