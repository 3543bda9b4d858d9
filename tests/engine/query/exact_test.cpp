// What    All hits against exact arithmetic: triangles and rays of small whole numbers, where 64 bits hold
//         every determinant; rays that pass no edge nearer than corners are displaced by have the hits that
//         geometry says, at its t.
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/query/meshes.h"
#include "engine/query/queried_scene.h"

namespace kdray::test {
namespace {

using Whole = glm::vec<3, std::int64_t>;

constexpr std::uint64_t kSeed = 77;
constexpr int kReach = 512;

Whole minus(const Whole& a, const Whole& b) {
  return a - b;
}
std::int64_t volume(const Whole& a, const Whole& b, const Whole& c) {
  return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}
double length(const Whole& v) {
  return glm::length(dvec3(v));
}

struct Answer {
  bool sure = true;
  std::map<std::uint32_t, double> hits;  // t by number
};

Answer ask_exactly(const std::vector<std::array<Whole, 3>>& triangles, const Whole& o, const Whole& d) {
  Answer answer;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Whole a = minus(triangles[i][0], o), b = minus(triangles[i][1], o), c = minus(triangles[i][2], o);
    const std::int64_t wa = volume(d, b, c), wb = volume(d, c, a), wc = volume(d, a, b);
    // The line's distance from an edge's line.
    const auto near = [&](std::int64_t w, const Whole& p, const Whole& q) {
      return std::abs(static_cast<double>(w)) <= 0.01 * length(d) * length(q - p);
    };
    const bool outside = (std::min({wa, wb, wc}) < 0) && (std::max({wa, wb, wc}) > 0);
    const std::int64_t det = wa + wb + wc;
    const bool in_doubt = near(wa, b, c) || near(wb, c, a) || near(wc, a, b);
    if (in_doubt) answer.sure = false;
    if (outside || det == 0) continue;
    const double t = static_cast<double>(volume(a, b, c)) / static_cast<double>(det);
    if (t > 0) answer.hits[i] = t;
    if (std::abs(t) * length(d) < 1) answer.sure = false;
  }
  return answer;
}

class Exact : public OnDevice {};

TEST_F(Exact, HitsAreThoseOfGeometry) {
  SCOPED_TRACE(kSeed);
  stress::Random random(kSeed, 0);
  const auto whole = [&] { return static_cast<std::int64_t>(random.below(2 * kReach + 1)) - kReach; };
  const auto point = [&] {
    const std::int64_t x = whole(), y = whole();
    return Whole(x, y, whole());
  };
  std::vector<std::array<Whole, 3>> triangles{{Whole(-kReach), Whole(kReach, -kReach, 0), Whole(kReach)}};
  while (triangles.size() < 40) triangles.push_back({point(), point(), point()});
  std::vector<dvec3> v;
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (const auto& t : triangles) {
    const auto first = static_cast<std::uint32_t>(v.size());
    for (const Whole& p : t) v.emplace_back(p);
    faces.push_back({first, first + 1, first + 2});
  }
  QueriedScene queried(mesh_of(v, faces), Space::worlds);
  ASSERT_EQ(queried.triangles().size(), triangles.size());
  std::vector<Ray> rays;
  std::vector<Answer> answers;
  for (int i = 0; i < 20000; ++i) {
    const Whole o = point();
    const Whole d = point();
    if (d == Whole(0)) continue;
    answers.push_back(ask_exactly(triangles, o, d));
    rays.push_back(ray_from(vec3(o), vec3(d)));
  }
  const query::LocalHits all = queried.all(rays);
  int sure = 0;
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!answers[i].sure) continue;
    ++sure;
    ASSERT_EQ(all.splits[i + 1] - all.splits[i], answers[i].hits.size()) << i << " " << in_words(rays[i]);
    for (std::size_t k = all.splits[i]; k < all.splits[i + 1]; ++k) {
      const auto hit = answers[i].hits.find(all.primitive[k]);
      ASSERT_NE(hit, answers[i].hits.end()) << i;
      ASSERT_NEAR(all.t[k], hit->second, 1e-3 * (1 + hit->second)) << i;
      ++hits;
    }
  }
  EXPECT_GT(sure, 15000);
  EXPECT_GT(hits, 15000);
}

}  // namespace
}  // namespace kdray::test
