// What    All hits of every kind of primitive, and of all of them together, are those that the oracle's
//         textbook formulas find in double, one after the other; closed solids of shapes are crossed an even
//         number of times, spheres by every ray.
#include <algorithm>
#include <cmath>

#include "conformance/all_kinds.h"
#include "engine/query/queried_scene.h"
#include "oracle/primitives.h"
#include "stress/random.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 12;

// What lies on the ray, in a world whose surfaces are moved outward by `grow`.
std::vector<oracle::Hit> hits_of(const oracle::World& world, oracle::Ray ray, double grow) {
  std::vector<oracle::Hit> hits;
  for (;;) {
    const oracle::Hit hit = world.closest(ray, grow);
    if (!hit.found() || hits.size() > 1000) return hits;
    hits.push_back(hit);
    ray.t_min = std::nextafter(hit.t, 1e30);
  }
}

std::vector<Ray> rays_through(std::size_t n, std::uint64_t seed) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < n; ++i) {
    stress::Random random(seed, i);
    const auto in_cube = [&](double half) {
      const double x = random.uniform(-half, half), y = random.uniform(-half, half);
      return dvec3(x, y, random.uniform(-half, half));
    };
    const vec3 o(in_cube(3));
    rays.push_back(ray_from(o, vec3(in_cube(1)) - o));
  }
  return rays;
}

void expect_as_oracle(const scene::Scene& s, std::size_t least_sure) {
  constexpr double kTolerance = 2e-5;
  QueriedScene queried(s, Space::worlds);
  const std::vector<Ray> rays = rays_through(2000, kSeed);
  const query::LocalHits all = queried.all(rays);
  const oracle::World world(s);
  std::size_t sure = 0, found = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    oracle::Ray ray{.origin = {rays[i].origin[0], rays[i].origin[1], rays[i].origin[2]},
                    .direction = {rays[i].direction[0], rays[i].direction[1], rays[i].direction[2]}};
    const auto wide = hits_of(world, ray, kTolerance), narrow = hits_of(world, ray, -kTolerance);
    const auto same = [](const oracle::Hit& a, const oracle::Hit& b) { return a.primitive == b.primitive; };
    if (!std::ranges::equal(wide, narrow, same)) continue;
    ++sure;
    ASSERT_EQ(all.splits[i + 1] - all.splits[i], narrow.size()) << "ray " << i << ": " << in_words(rays[i]);
    for (std::size_t k = 0; k < narrow.size(); ++k) {
      const std::size_t at = all.splits[i] + k;
      ASSERT_EQ(all.primitive[at], static_cast<std::uint32_t>(narrow[k].primitive)) << in_words(rays[i]);
      const double apart = std::abs(wide[k].t - narrow[k].t);
      ASSERT_NEAR(all.t[at], narrow[k].t, apart + 1e-3) << in_words(rays[i]);
      ++found;
    }
  }
  EXPECT_GT(sure, least_sure);
  EXPECT_GT(found, 1000);
}

class AgainstOracle : public OnDevice {};

TEST_F(AgainstOracle, HitsOfEachKind) {
  primitives::for_each_kind([](auto kind) {
    SCOPED_TRACE(decltype(kind)::kName);
    expect_as_oracle(scene_of<decltype(kind)>(60, kSeed), 1500);
  });
}

TEST_F(AgainstOracle, HitsOfAllKindsTogether) {
  expect_as_oracle(mixed_scene(20, kSeed), 1500);
}

// Aimed at their outlines, where two hits become one and none.
TEST_F(AgainstOracle, SpheresAreCrossedTwiceOrNotAtAll) {
  oracle::SceneBuilder builder;
  builder.sphere({0.3, -0.2, 0.1}, 1, {}).sphere({0, 0, 0}, 1e-3, {}).sphere({5, 5, 5}, 2, {});
  QueriedScene queried(builder.scene(), Space::worlds);
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 50000; ++i) {
    stress::Random random(kSeed + 1, i);
    const dvec3 center(0.3, -0.2, 0.1), o = 40.0 * random.direction();
    const dvec3 to = center - o, aside = glm::normalize(glm::cross(to, random.direction()));
    const double distance = glm::length(to), sine = 1 / distance;
    const double off = random.below(4) ? random.signed_log_uniform(1e-9, 1e-2) : 0;
    const dvec3 d = to * std::sqrt(1 - sine * sine) + aside * (1 + off) * distance * sine;
    rays.push_back(ray_from(vec3(o), vec3(d)));
  }
  const std::vector<std::uint32_t> counts = queried.count(rays);
  int crossed = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(counts[i] % 2, 0) << in_words(rays[i]);
    crossed += counts[i] > 0;
  }
  EXPECT_GT(crossed, 10000);
  EXPECT_LT(crossed, 45000);
}

// A cone without caps, and discs for its caps.
TEST_F(AgainstOracle, AConeWithCapsIsCrossedAnEvenNumberOfTimes) {
  oracle::SceneBuilder builder;
  builder.cone({0, 0, -1}, 1, {0, 0, 1}, 0.5, {})
      .disc({0, 0, -1}, {0, 0, -1}, 1, {})
      .disc({0, 0, 1}, {0, 0, 1}, 0.5, {});
  QueriedScene queried(builder.scene(), Space::worlds);
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 50000; ++i) {
    stress::Random random(kSeed + 2, i);
    const dvec3 o = 10.0 * random.direction(),
                at(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    rays.push_back(ray_from(vec3(o), vec3(at - o)));
  }
  const std::vector<std::uint32_t> counts = queried.count(rays);
  int odd = 0, crossed = 0;
  for (const std::uint32_t n : counts) {
    odd += n % 2;
    crossed += n > 0;
  }
  EXPECT_LE(odd, 1);  // at the rims, where rounding may decide two ways
  EXPECT_GT(crossed, 20000);
}

}  // namespace
}  // namespace kdray::test
