// What    The rays of a bench are what their classes say: how many, where from, where to. The scene is a
//         floor, z = 0, whose hits are known without tracing. No seed: the makers' own are fixed.
#include "bench/workload/rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "bench/workload/pixel_order.h"

namespace kdray::bench {
namespace {

constexpr int kSide = 20;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Two metres above a floor of two large triangles, looking down at an angle; a light to the side.
scene::Scene floor_scene() {
  scene::Scene s;
  s.vertices = {{-100, -100, 0}, {100, -100, 0}, {100, 100, 0}, {-100, 100, 0}};
  s.triangles.resize(2);
  s.triangles[0].vertex = {0, 1, 2};
  s.triangles[1].vertex = {0, 2, 3};
  s.triangles[1].number = 1;
  s.materials.emplace_back();
  s.lights.emplace_back().position = {3, 1, 5};
  s.camera = {.from = {0, 0, 2}, .at = {1, 1, 0}, .up = {0, 0, 1}, .vertical_fov = 0.7};
  return s;
}

std::vector<Hit> hits_of_floor(std::span<const Ray> rays) {
  std::vector<Hit> hits;
  for (const Ray& r : rays) {
    const float t = -r.origin[2] / r.direction[2];
    hits.push_back(t > 0 ? Hit{t, 0, 0, 0} : Hit{kInfinity, -1, 0, 0});
  }
  return hits;
}

std::vector<RayClass> all_classes(const scene::Scene& scene) {
  const std::vector<std::string> names(class_names().begin(), class_names().end());
  return make_classes(scene, names, kSide, hits_of_floor);
}

RayClass one_class(const scene::Scene& scene, const std::string& name) {
  return make_classes(scene, std::span(&name, 1), kSide, hits_of_floor).at(0);
}

dvec3 origin_of(const Ray& r) {
  return {r.origin[0], r.origin[1], r.origin[2]};
}
dvec3 direction_of(const Ray& r) {
  return {r.direction[0], r.direction[1], r.direction[2]};
}

TEST(PixelOrder, VisitsEachPixelOnce) {
  for (const int side : {1, 2, 7, 64, 100})
    for (const auto& pixels : {morton_order(side), scanline_order(side)}) {
      std::set<std::pair<int, int>> seen;
      for (const Pixel& p : pixels) {
        EXPECT_TRUE(p.x >= 0 && p.x < side && p.y >= 0 && p.y < side);
        seen.emplace(p.x, p.y);
      }
      EXPECT_EQ(pixels.size(), static_cast<std::size_t>(side * side));
      EXPECT_EQ(seen.size(), pixels.size());
    }
}

TEST(PixelOrder, MortonKeepsBlocksTogether) {
  const std::vector<Pixel> order = morton_order(8);
  EXPECT_EQ(order[0], (Pixel{0, 0}));
  EXPECT_EQ(order[1], (Pixel{1, 0}));
  EXPECT_EQ(order[2], (Pixel{0, 1}));
  EXPECT_EQ(order[3], (Pixel{1, 1}));
  EXPECT_EQ(order[4], (Pixel{2, 0}));
  for (std::size_t i = 0; i < 16; ++i) EXPECT_TRUE(order[i].x < 4 && order[i].y < 4) << i;
}

TEST(Rays, AreAsManyAsPixels) {
  const std::vector<RayClass> classes = all_classes(floor_scene());
  ASSERT_EQ(classes.size(), class_names().size());
  for (std::size_t i = 0; i < classes.size(); ++i) {
    EXPECT_EQ(classes[i].name, class_names()[i]);
    EXPECT_EQ(classes[i].rays.size(), static_cast<std::size_t>(kSide * kSide)) << classes[i].name;
    EXPECT_EQ(classes[i].any_hit, classes[i].name == "shadow");
  }
}

TEST(Rays, HaveUnitDirectionsAndAnInterval) {
  for (const RayClass& c : all_classes(floor_scene()))
    for (const Ray& r : c.rays) {
      EXPECT_NEAR(glm::length(direction_of(r)), 1, 1e-6) << c.name;
      EXPECT_TRUE(r.t_min >= 0 && r.t_max > r.t_min) << c.name;
    }
}

TEST(Rays, PrimaryBeginAtTheEyeBeyondHither) {
  scene::Scene s = floor_scene();
  s.camera->hither = 0.25;
  const dvec3 forward = glm::normalize(s.camera->at - s.camera->from);
  for (const Ray& r : one_class(s, "primary").rays) {
    EXPECT_EQ(origin_of(r), s.camera->from);
    EXPECT_NEAR(glm::dot(direction_of(r), forward) * static_cast<double>(r.t_min), 0.25, 1e-6);
  }
}

TEST(Rays, ScanlineIsPrimaryInAnotherOrder) {
  const scene::Scene s = floor_scene();
  const auto sorted = [](const std::vector<Ray>& rays) {
    std::multiset<std::array<float, 3>> directions;
    for (const Ray& r : rays) directions.insert({r.direction[0], r.direction[1], r.direction[2]});
    return directions;
  };
  EXPECT_EQ(sorted(one_class(s, "primary").rays), sorted(one_class(s, "scanline").rays));
}

TEST(Rays, ShadowRaysEndAtTheLight) {
  const scene::Scene s = floor_scene();
  for (const Ray& r : one_class(s, "shadow").rays) {
    const dvec3 end = origin_of(r) + direction_of(r) * static_cast<double>(r.t_max);
    EXPECT_LT(glm::length(end - s.lights[0].position), 1e-5);
  }
}

TEST(Rays, NoShadowRayToALightBehindTheSurfaceAndNoneWithoutLight) {
  scene::Scene s = floor_scene();
  s.lights[0].position = {3, 1, -5};
  EXPECT_TRUE(one_class(s, "shadow").rays.empty());
  s.lights.clear();
  EXPECT_TRUE(one_class(s, "shadow").rays.empty());
}

TEST(Rays, SecondaryRaysBeginOffTheirSurfaceOnTheRightSide) {
  const scene::Scene s = floor_scene();
  const double offset = offset_of(s);
  EXPECT_GT(offset, 0);
  for (const RayClass& c : all_classes(s)) {
    if (c.name == "primary" || c.name == "scanline" || c.name == "random") continue;
    const double side = c.name == "refracted" ? -1 : 1;
    for (const Ray& r : c.rays) {
      EXPECT_NEAR(r.origin[2], side * offset, 0.02 * offset) << c.name;
      EXPECT_GT(side * static_cast<double>(r.direction[2]), 0) << c.name;
    }
  }
}

TEST(Rays, MirrorAndRefractedObeyTheirLaws) {
  const scene::Scene s = floor_scene();
  const RayClass eye = one_class(s, "primary"), mirror = one_class(s, "mirror"),
                 refracted = one_class(s, "refracted");
  for (std::size_t i = 0; i < eye.rays.size(); ++i) {
    const dvec3 in = direction_of(eye.rays[i]);
    EXPECT_LT(glm::length(direction_of(mirror.rays[i]) - dvec3(in.x, in.y, -in.z)), 1e-6);
    // The sines, parallel to the floor, are as 1.5 to 1.
    const dvec3 out = direction_of(refracted.rays[i]);
    EXPECT_LT(glm::length(glm::dvec2(out) * 1.5 - glm::dvec2(in)), 1e-6);
  }
}

TEST(Rays, DiffuseRaysFollowTheCosine) {
  double mean = 0;
  const RayClass c = one_class(floor_scene(), "diffuse");
  for (const Ray& r : c.rays)
    mean += static_cast<double>(r.direction[2]) / static_cast<double>(c.rays.size());
  // The mean cosine is 2/3, its deviation 0.236 / sqrt(400) = 0.012.
  EXPECT_NEAR(mean, 2.0 / 3, 0.05);
}

TEST(Rays, RandomRaysBeginInTheBounds) {
  const scene::Scene s = floor_scene();
  const DBox bounds = s.bounds();
  dvec3 mean(0);
  const RayClass c = one_class(s, "random");
  for (const Ray& r : c.rays) {
    const dvec3 o = origin_of(r);
    EXPECT_TRUE(glm::all(glm::lessThanEqual(bounds.lo, o)) && glm::all(glm::lessThanEqual(o, bounds.hi)));
    mean += direction_of(r) / static_cast<double>(c.rays.size());
  }
  EXPECT_LT(glm::length(mean), 0.15);  // three deviations of 1 / sqrt(400)
}

}  // namespace
}  // namespace kdray::bench
