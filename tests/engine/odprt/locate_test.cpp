// What    Which subtree a point lies in, against all subtrees in turn.
#include "engine/odprt/subtrees.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/odprt/prepared_scenes.h"

namespace kdray::test {
namespace {

float distance_to(const Box& box, const vec3& p) {
  const vec3 outside = glm::max(glm::max(box.lo - p, p - box.hi), vec3(0));
  return glm::dot(outside, outside);
}

TEST(Locator, FindsTheNearestOfAll) {
  const auto seed = std::random_device()();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const auto& [name, scene] : prepared_scenes())
    for (const std::size_t n : {1u, 64u, 512u}) {
      const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, n);
      const odprt::Locator locator(scene.wide, cut);
      if (cut.subtrees.empty()) {
        EXPECT_FALSE(locator.find(vec3(0)));
        continue;
      }
      const Box& bounds = scene.geometry.bounds;
      std::uniform_real_distribution<float> share(-0.1f, 1.1f);
      for (int i = 0; i < 2000; ++i) {
        const vec3 p = bounds.lo + bounds.extent() * vec3(share(random), share(random), share(random));
        float least = std::numeric_limits<float>::infinity();
        for (const odprt::Subtree& s : cut.subtrees) least = std::min(least, distance_to(s.bounds, p));
        const auto found = locator.find(p);
        ASSERT_TRUE(found) << name;
        EXPECT_EQ(distance_to(cut.subtrees[*found].bounds, p), least) << name << ", of " << n;
      }
    }
}

}  // namespace
}  // namespace kdray::test
