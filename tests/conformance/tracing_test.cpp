// What every kind owes to rays: hits and pictures as the oracle has them, the same bits by every walk, in
//         both modes, with
// every rule of skipping off, from a cache; and soundness by verify's own measure.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>

#include "accel/cache/entry.h"
#include "accel/prepare/prepared.h"
#include "apps/verify/verify.h"
#include "conformance/all_kinds.h"
#include "kdray/kdray.h"
#include "layout/rules.h"
#include "oracle/primitives.h"
#include "pictures/like_oracle.h"
#include "pictures/render.h"
#include "support/device.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 20261124;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Ray ray_from(const vec3& o, const vec3& d) {
  return {{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInfinity};
}

// From around the scene and from within, at places on primitives, in every direction and along the axes.
template <class Kind>
std::vector<Ray> rays_for(const scene::Scene& s, std::size_t n) {
  Draw random(kSeed + 1);  // another than the scene's, or rays would begin where primitives are
  const scene::Geometry g = scene::make_geometry(s);
  const auto& all = Kind::of(g);
  std::vector<Ray> rays;
  while (rays.size() < n) {
    const vec3 origin(random.in_cube(random.below(2) == 0 ? 1 : 3));
    const dvec3 local(Samples<Kind>::point(all[random.below(all.size())], random));
    const vec3 target(g.space.world(local));
    vec3 d = random.below(4) == 0 ? vec3(random.axis_or_any()) : target - origin;
    if (d == vec3(0)) continue;
    rays.push_back(ray_from(origin, d));
  }
  return rays;
}

std::string device_there() {
  const std::vector<std::string> found = usable_devices();
  return found.empty() ? "" : found.front();
}

template <class Kind>
class TracingOf : public testing::Test {
 protected:
  void SetUp() override {
    if (device_there().empty()) GTEST_SKIP() << "no OpenCL device";
  }
  DeviceOptions device(int queues = 1) const {
    return device_of({.device = device_there(), .queues = queues});
  }

  scene::Scene scene_ = scene_of<Kind>(120, kSeed);
};
TYPED_TEST_SUITE(TracingOf, AllKinds, KindNames);

bool same(const Hit& a, const Hit& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

oracle::Ray exact(const Ray& r) {
  return {.origin = {r.origin[0], r.origin[1], r.origin[2]},
          .direction = {r.direction[0], r.direction[1], r.direction[2]}};
}

// What a grown and a shrunk world agree on, no rounding of that size can change.
void expect_as_oracle(const scene::Scene& s, const std::vector<Ray>& rays, const std::vector<Hit>& hits,
                      double grow, double tolerance) {
  const oracle::World world(s);
  int sure = 0, wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const oracle::Ray ray = exact(rays[i]);
    const oracle::Hit wide = world.closest(ray, grow), narrow = world.closest(ray, -grow);
    if (wide.primitive != narrow.primitive) continue;
    // Where a ray grazes, its hit moves by more than the surface does: over the sine of the angle, or, where
    // the surface is curved, as far as these two are apart.
    double apart = 0;
    if (narrow.found()) {
      const double sine =
          std::abs(glm::dot(world.surface(ray, narrow).outward, glm::normalize(ray.direction)));
      if (sine < 1e-3) continue;
      apart = std::abs(wide.t - narrow.t) + tolerance / sine;
    }
    ++sure;
    const Hit& hit = hits[i];
    const auto near = [](double a, double b, double most) { return std::abs(a - b) <= most; };
    // What is small, or long and thin, is crossed within some hundred times its error.
    const double across = 0.02 + 100 * apart;
    const bool found = hit.primitive == narrow.primitive &&
                       (!narrow.found() || (near(hit.t, narrow.t, apart + tolerance * (1 + narrow.t)) &&
                                            near(hit.u, narrow.u, across) && near(hit.v, narrow.v, across)));
    if (!found && ++wrong < 5)
      ADD_FAILURE() << "ray " << i << ", seed " << kSeed << ": t " << hit.t << " u " << hit.u << " v "
                    << hit.v << " of " << hit.primitive << ", the oracle's " << narrow.t << " " << narrow.u
                    << " " << narrow.v << " of " << narrow.primitive;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(sure, static_cast<int>(rays.size() * 3 / 4));  // many aim at rims and edges
}

constexpr Traversal kWalks[] = {Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic};

TYPED_TEST(TracingOf, HitsAreTheOraclesByEveryWalk) {
  const std::vector<Ray> rays = rays_for<TypeParam>(this->scene_, 3000);
  Renderer renderer(Scene(scene::Scene(this->scene_)), {}, this->device());
  const auto closest = renderer.trace(rays, false, 1, Traversal::binary);
  const auto any = renderer.trace(rays, true, 1, Traversal::binary);
  expect_as_oracle(this->scene_, rays, closest, 2e-5, 2e-5);
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits += closest[i].primitive >= 0 ? 1 : 0;
    EXPECT_EQ(closest[i].primitive >= 0, any[i].t == 0) << "ray " << i;
  }
  EXPECT_GT(hits, 1000);
  for (const Traversal walk : kWalks) {
    EXPECT_TRUE(std::ranges::equal(closest, renderer.trace(rays, false, 1, walk), same));
    EXPECT_TRUE(std::ranges::equal(any, renderer.trace(rays, true, 1, walk), same));
  }
}

TYPED_TEST(TracingOf, DoublePrecisionIsFiner) {
  if (!computes_in_double(device_there())) GTEST_SKIP() << "the device does not compute in double";
  const std::vector<Ray> rays = rays_for<TypeParam>(this->scene_, 1000);
  Renderer renderer(Scene(scene::Scene(this->scene_)), {}, this->device());
  // The scene itself is in float: what it is rounded to is what the oracle's is moved by.
  expect_as_oracle(this->scene_, rays,
                   renderer.trace(rays, false, 1, Traversal::automatic, Precision::float64), 1e-6, 1e-6);
}

// Normals, materials, sides: matte ones, mirrors and glass, as the oracle shades them.
TYPED_TEST(TracingOf, PicturesAreTheOracles) {
  const scene::Scene model = scene_of<TypeParam>(40, kSeed + 2);
  const RenderOptions options = exact_options(72, 54, 3);
  Renderer renderer(Scene(scene::Scene(model)), {}, this->device());
  const Picture picture = renderer.render(options);
  expect_like(picture, oracle::trace_picture(model, options.width, options.height, options.depth));
}

// Both modes, both schedules, and with no work left out: one picture. It shows something.
TYPED_TEST(TracingOf, PicturesAreTheSameBits) {
  Scene scene{scene::Scene(this->scene_)};
  Renderer renderer(scene, {}, this->device());
  RenderOptions options = exact_options(48, 36, 4);
  const Picture usual = renderer.render(options);
  EXPECT_TRUE(all_finite(usual));
  const float* const first = usual.rgb.data();
  EXPECT_TRUE(std::any_of(first, first + usual.rgb.size(), [&](float v) { return v != *first; }));
  for (const Traversal walk : kWalks) {
    options.traversal = walk;
    EXPECT_TRUE(same_bits(usual.rgb, renderer.render(options).rgb)) << "walk " << static_cast<int>(walk);
  }
  options.traversal = Traversal::automatic;
  api::keep(renderer, KDRAY_KEEP_ALL);
  EXPECT_TRUE(same_bits(usual.rgb, renderer.render(options).rgb)) << "rules of skipping";
  api::keep(renderer, 0);
  DeviceOptions global = this->device();
  global.schedule = Schedule::global;
  EXPECT_TRUE(same_bits(usual.rgb, Renderer(scene, {}, global).render(options).rgb)) << "global schedule";
  options.mode = Mode::odprt;
  EXPECT_TRUE(same_bits(usual.rgb, Renderer(scene, {}, this->device(2)).render(options).rgb)) << "ODPRT";
}

// Faces around a core, whose boxes must hold the kind's primitives: or their shadows are lost.
TYPED_TEST(TracingOf, ACoreHoldsIt) {
  scene::Scene s = this->scene_;
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const dvec3& corner : {dvec3(-9, -2, -9), {9, -2, -9}, {9, -2, 9}, {-9, -2, 9}})
    s.vertices.push_back(corner);
  for (const std::uint32_t k : {1u, 2u}) {
    scene::Triangle t{.vertex = {first, first + k + 1, first + k}};
    t.number = next_number(s);
    s.triangles.push_back(t);
  }
  Renderer renderer(Scene(std::move(s)), {}, this->device());
  RenderOptions options = exact_options(48, 36, 4);
  const Picture usual = renderer.render(options);
  EXPECT_GT(statistics_of(renderer)["rays"]["skipped"]["light_in_the_open"], 0);
  api::keep(renderer, KDRAY_KEEP_OPEN);
  EXPECT_TRUE(same_bits(usual.rgb, renderer.render(options).rgb));
}

// Kept in a file and read again, it is the same scene.
TYPED_TEST(TracingOf, ComesBackFromACache) {
  const prepare::Prepared made = prepare::prepare(this->scene_, TreeOptions{});
  EXPECT_EQ(TypeParam::of(made.counts), TypeParam::of(this->scene_).size());
  EXPECT_EQ(TypeParam::of(made.flat).size(), TypeParam::of(made.counts));
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("kdray_kind_" + std::string(TypeParam::kName) + ".entry");
  cache::write_entry(file, Hash{1, 2}, made);
  std::optional<prepare::Prepared> read = cache::read_entry(file, Hash{1, 2});
  std::filesystem::remove(file);
  ASSERT_TRUE(read);
  EXPECT_EQ(TypeParam::of(read->counts), TypeParam::of(made.counts));
  const RenderOptions options = exact_options(48, 36, 4);
  const Picture a = Renderer(PreparedScene(prepare::Prepared(made)), this->device()).render(options);
  EXPECT_TRUE(
      same_bits(a.rgb, Renderer(PreparedScene(std::move(*read)), this->device()).render(options).rgb));
}

TYPED_TEST(TracingOf, IsCounted) {
  Renderer renderer(Scene(scene::Scene(this->scene_)), {}, this->device());
  renderer.render(exact_options(8, 8, 1));
  const nlohmann::json statistics = statistics_of(renderer);
  EXPECT_EQ(statistics["scene"][TypeParam::kNames], TypeParam::of(this->scene_).size());
  const auto& on = statistics["features"]["on"];
  EXPECT_TRUE(std::find(on.begin(), on.end(), TypeParam::kNames) != on.end());
}

// No lost hit, no ray that meets again what it left, no walk that differs, no value that is no number.
TYPED_TEST(TracingOf, IsSoundByVerify) {
  for (const int n : {1, 120}) {
    const verify::Findings found = verify::verify(scene_of<TypeParam>(n, kSeed + 1),
                                                  {.rays = 1 << 14, .device = {.device = device_there()}});
    EXPECT_TRUE(found.film.fault.empty() && found.film.not_finite == 0) << found.film.fault;
    EXPECT_LE(found.probes.defects(), kKnownSelfHits<TypeParam>);
    EXPECT_EQ(found.probes.defects(), found.probes.count[static_cast<std::size_t>(verify::Defect::self_hit)]);
    EXPECT_EQ(TypeParam::of(found.counts), static_cast<std::uint64_t>(n));
  }
}

// All kinds beside each other, in one leaf as well.
TEST(TracingOfAllKinds, TogetherTheyAreWhatTheOracleSays) {
  if (device_there().empty()) GTEST_SKIP() << "no OpenCL device";
  const scene::Scene s = mixed_scene(40, kSeed);
  std::vector<Ray> rays;
  primitives::for_each_kind([&](auto kind) {
    const std::vector<Ray> some = rays_for<decltype(kind)>(s, 1000);
    rays.insert(rays.end(), some.begin(), some.end());
  });
  Renderer renderer(Scene(scene::Scene(s)), {}, device_of({.device = device_there()}));
  const auto closest = renderer.trace(rays, false, 1, Traversal::binary);
  expect_as_oracle(s, rays, closest, 2e-5, 2e-5);
  for (const Traversal walk : kWalks)
    EXPECT_TRUE(std::ranges::equal(closest, renderer.trace(rays, false, 1, walk), same));
}

}  // namespace
}  // namespace kdray::test
