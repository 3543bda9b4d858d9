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

#include "base/local_space.h"
#include "layout/tree.layout.h"
#include "stress/exact.h"
#include "stress/random.h"
#include "stress/self_hits.h"
#include "stress/spawn.h"
#include "stress/table.h"
#include "stress/traced.h"
#include "support/all_kinds.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 60;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Steep as often as grazing, down to 1e-6 rad; away from the surface on the side of `n`.
dvec3 leaving(const dvec3& n, Random& random) {
  const double angle = random.bits() & 1 ? random.uniform(0.01, 1.5) : random.log_uniform(1e-6, 0.1);
  return std::cos(angle) * tangent_to(n, random) + std::sin(angle) * n;
}

std::string described(const layout::Triangle& t) {
  std::string all = "triangle";
  for (const auto& v : t.v)
    for (const float c : v) all += fmt::format(" {:a}", c);
  return all;
}
double largest_coordinate(const layout::Triangle& t) {
  double m = 0;
  for (const auto& v : t.v)
    for (const float c : v) m = std::max<double>(m, std::abs(c));
  return m;
}
// Of a shape by its rows, and by its box, which is wider than it by no more than rounding.
template <class Surface>
std::string described(const Surface& surface) {
  std::string all = "rows";
  for (const float row : primitives::rows_of(surface)) all += fmt::format(" {:a}", row);
  return all;
}
template <class Surface>
double largest_coordinate(const Surface& surface) {
  const Box box = primitives::bounds_of(surface);
  return std::max(largest_component(dvec3(box.lo)), largest_component(dvec3(box.hi)));
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
        departures_.push_back(
            {primitive.number, inwards, to_light, radius_at(primitive, point3(s.point)), step, blur});
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
