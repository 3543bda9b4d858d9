// What    All hits over a refitted tree are those over a built one, bit for bit, by every walk: in closed
//         meshes that are bent, sheared and flattened, in blocks of four and of eight, and beside shapes.
#include "accel/prepare/refit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "conformance/all_kinds.h"
#include "engine/query/meshes.h"
#include "engine/query/queried_scene.h"
#include "engine/query/trace.h"
#include "stress/random.h"

namespace kdray::test {
namespace {

using query::LocalHits;

constexpr std::uint64_t kSeed = 47;
constexpr Traversal kWalks[] = {Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic};

template <class T>
bool same_bits(const T& a, const T& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}
bool same(const LocalHits& a, const LocalHits& b) {
  return same_bits(a.splits, b.splits) && same_bits(a.t, b.t) && same_bits(a.primitive, b.primitive) &&
         same_bits(a.u, b.u) && same_bits(a.v, b.v) && same_bits(a.more, b.more);
}

// Half of them towards a vertex of the mesh; some alone, some sixteen of a kind.
std::vector<Ray> rays_at(const scene::Scene& scene, std::size_t n) {
  const DBox box = scene.bounds();
  const dvec3 size = box.extent();
  std::vector<Ray> rays;
  for (std::size_t i = 0; rays.size() < n; ++i) {
    stress::Random random(kSeed, i);
    const auto anywhere = [&](double by) {
      return box.center() +
             by * size * dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    };
    const dvec3 from = anywhere(2);
    dvec3 to = anywhere(0.6);
    if (random.below(2) && !scene.vertices.empty())
      to = scene.vertices[random.below(static_cast<std::uint32_t>(scene.vertices.size()))];
    const int alike = random.below(2) ? 16 : 1;
    for (int k = 0; k < alike; ++k) {
      const dvec3 aside =
          k == 0 ? dvec3(0) : 0.02 * size * dvec3(random.uniform(-1, 1), random.uniform(-1, 1), 0);
      rays.push_back(ray_from(vec3(from), vec3(to + aside - from), 0,
                              random.below(4) ? std::numeric_limits<float>::infinity() : 1.2f));
    }
  }
  return rays;
}

void expect_same_hits(QueriedScene& refitted, QueriedScene& built, const std::vector<Ray>& rays) {
  const LocalHits all = built.all(rays, {.traversal = Traversal::wide});
  const std::vector<Hit> closest = query::trace(built.target(Traversal::wide), rays, {}).hits;
  EXPECT_GT(all.t.size(), rays.size() / 8);
  for (const Traversal walk : kWalks) {
    EXPECT_TRUE(same(all, refitted.all(rays, {.traversal = walk}))) << "walk " << static_cast<int>(walk);
    const std::vector<std::uint32_t> counts = refitted.count(rays, {.traversal = walk});
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_EQ(counts[i], all.splits[i + 1] - all.splits[i]) << in_words(rays[i]);
    const std::vector<Hit> hits = query::trace(refitted.target(walk), rays, {}).hits;
    const std::vector<Hit> any = query::trace(refitted.target(walk), rays, {.any_hit = true}).hits;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(std::memcmp(&hits[i], &closest[i], sizeof hits[i]), 0) << in_words(rays[i]);
      ASSERT_EQ(any[i].t == 0, closest[i].primitive >= 0) << in_words(rays[i]);
    }
  }
}

struct NamedMove {
  const char* name;
  dvec3 (*to)(const dvec3& place, const dvec3& size);
};
constexpr NamedMove kMoves[] = {
    {"bent",
     [](const dvec3& v, const dvec3& size) {
       return v +
              0.1 * size *
                  dvec3(std::sin(6 * v.y / size.y), std::cos(5 * v.z / size.z), std::sin(4 * v.x / size.x));
     }},
    {"sheared",
     [](const dvec3& v, const dvec3& size) { return v + dvec3(0.7 * size.x * v.y / size.y, 0, 0); }},
    {"flattened", [](const dvec3& v, const dvec3&) { return v * dvec3(1, 0.002, 1); }},
};

void expect_refits(scene::Scene scene, Blocks blocks) {
  const prepare::Prepared first = prepared_of(scene, blocks);
  const prepare::Fitting fitting(first);
  const auto vertices = scene.vertices;
  const dvec3 size = scene.bounds().extent();
  int refits = 0;
  for (const NamedMove& move : kMoves) {
    SCOPED_TRACE(move.name);
    for (std::size_t i = 0; i < vertices.size(); ++i) scene.vertices[i] = move.to(vertices[i], size);
    prepare::Refitted made = prepare::refit(scene, first, fitting, std::numeric_limits<double>::infinity());
    if (!made.scene) continue;  // triangles have lost their area, or found one
    ++refits;
    QueriedScene refitted(std::move(*made.scene)), built(prepared_of(scene, blocks, first.geometry.space));
    EXPECT_EQ(refitted.prepared().features, built.prepared().features);
    expect_same_hits(refitted, built, rays_at(scene, 1500));
  }
  EXPECT_GE(refits, 2);
}

class RefitWalks : public OnDevice {};

TEST_F(RefitWalks, FindWhatTheyFindInABuiltTree) {
  for (const NamedMesh& m : {NamedMesh{"torus", torus(24, 12)},
                             {"slivers", slivers(60)},
                             {"nested", nested()},
                             {"doubled", doubled()},
                             {"fine", icosphere(4)}})
    for (const Blocks blocks : {Blocks::suited, Blocks::of_eight}) {
      SCOPED_TRACE(m.name + (blocks == Blocks::suited ? "" : ", in blocks of eight"));
      expect_refits(m.scene, blocks);
    }
}

TEST_F(RefitWalks, FindShapesThatHaveNotMoved) {
  expect_refits(mixed_scene(100, kSeed), Blocks::suited);
}

}  // namespace
}  // namespace kdray::test
