// What    Every kind of primitive in the benches, from the list of kinds: normals and rays against the
//         oracle, materials, counts and words.
#include <gtest/gtest.h>

#include <sstream>

#include "bench/modes/lives.h"
#include "bench/povray/povray.h"
#include "bench/workload/kinds.h"
#include "bench/workload/rays.h"
#include "bench/workload/surfaces.h"
#include "conformance/all_kinds.h"
#include "oracle/oracle.h"

namespace kdray::bench {
namespace {

constexpr std::uint64_t kSeed = 20261124;

oracle::Ray exact(const Ray& r) {
  return {.origin = {r.origin[0], r.origin[1], r.origin[2]},
          .direction = {r.direction[0], r.direction[1], r.direction[2]},
          .t_min = r.t_min,
          .t_max = r.t_max};
}

// The oracle in the tracer's place.
std::vector<Hit> hits_of(const oracle::World& world, std::span<const Ray> rays) {
  std::vector<Hit> hits;
  for (const Ray& ray : rays) {
    const oracle::Hit hit = world.closest(exact(ray));
    hits.push_back({static_cast<float>(hit.t), hit.primitive, 0, 0});
  }
  return hits;
}

template <class Kind>
class BenchOf : public testing::Test {
 protected:
  Tracer tracer() const {
    return [this](std::span<const Ray> rays) { return hits_of(world_, rays); };
  }

  scene::Scene scene_ = test::scene_of<Kind>(40, kSeed);
  oracle::World world_{scene_};
};
TYPED_TEST_SUITE(BenchOf, test::AllKinds, test::KindNames);

TYPED_TEST(BenchOf, NormalsAreTheOracles) {
  const Surfaces surfaces(this->scene_);
  test::Draw draw(kSeed);
  int met = 0;
  for (std::size_t i = 0; i < 2000; ++i) {
    const dvec3 from = 4.0 * draw.direction(), to = draw.in_cube(0.5);
    const oracle::Ray ray{.origin = from, .direction = to - from};
    const oracle::Hit hit = this->world_.closest(ray);
    if (!hit.found()) continue;
    ++met;
    const oracle::Surface wanted = this->world_.surface(ray, hit);
    const dvec3 found = surfaces.normal(static_cast<std::uint32_t>(hit.primitive), wanted.point);
    EXPECT_NEAR(std::abs(glm::dot(found, wanted.outward)), 1, 1e-9) << "ray " << i << ", seed " << kSeed;
  }
  EXPECT_GT(met, 200);
}

// Of what the eye rays meet; away from it: a ray that leaves a surface meets it again only within a solid.
TYPED_TEST(BenchOf, MirrorRaysLeaveWhatTheyCameFrom) {
  const std::vector<std::string> names{"primary", "mirror"};
  const std::vector<RayClass> classes = make_classes(this->scene_, names, 32, this->tracer());
  ASSERT_EQ(classes.size(), 2u);
  std::size_t i = 0;
  for (const Hit& hit : hits_of(this->world_, classes[0].rays)) {
    if (hit.primitive < 0) continue;
    ASSERT_LT(i, classes[1].rays.size());
    const oracle::Ray ray = exact(classes[1].rays[i++]);
    const oracle::Hit next = this->world_.closest(ray);
    EXPECT_FALSE(next.primitive == hit.primitive && next.t < 16 * offset_of(this->scene_)) << "ray " << i;
  }
  EXPECT_EQ(i, classes[1].rays.size());
  EXPECT_GT(i, 100u);
}

TYPED_TEST(BenchOf, LivesWearItsMaterials) {
  scene::Scene s = this->scene_;
  for (auto& p : TypeParam::of(s)) p.material = 1;  // a mirror, which the first material is not
  const oracle::World world(s);
  const std::vector<LifeRay> lives =
      make_lives(s, {16, 12, 2, 0}, [&](std::span<const Ray> rays) { return hits_of(world, rays); });
  const auto n = [&](LifeKind kind) {
    return std::count_if(lives.begin(), lives.end(), [&](const LifeRay& l) { return l.kind == kind; });
  };
  EXPECT_EQ(n(LifeKind::reflected), std::count_if(lives.begin(), lives.end(), [](const LifeRay& l) {
              return l.kind == LifeKind::primary && l.hit;
            }));
  EXPECT_GT(n(LifeKind::reflected), 10);
}

TYPED_TEST(BenchOf, IsCountedByItsName) {
  const KindCounts counts = kind_counts(this->scene_);
  EXPECT_EQ(in_words(counts), std::string("40 ") + TypeParam::kNames);
  EXPECT_EQ(json_of(counts)[TypeParam::kNames], 40);
}

// By its material; or nothing is said of it, and that the scene can't be told.
TYPED_TEST(BenchOf, PovRayIsToldOfEachOne) {
  std::ostringstream out;
  write_pov(out, this->scene_, 1, 5, 0.01);
  const std::string text = out.str(), name = TypeParam::kIsShape ? " interior { I" : "triangle {";
  std::size_t n = 0;
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) ++n;
  EXPECT_EQ(n, pov_has_words_for(this->scene_) ? 40u : 0u);
}

}  // namespace
}  // namespace kdray::bench
