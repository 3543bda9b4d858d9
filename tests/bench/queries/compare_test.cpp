// What    What counts as another answer in `kdray bench queries`.
#include "bench/race/compare.h"

#include <gtest/gtest.h>

#include <limits>

namespace kdray::bench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Answers distances(std::vector<float> t) {
  Answers answers(Question::closest, t.size());
  answers.t = std::move(t);
  return answers;
}

TEST(CompareAnswers, DistancesMayDifferByRounding) {
  const Answers a = distances({1, 1, kInfinity, 100, 0, kInfinity}),
                b = distances({1.00005f, 1.001f, kInfinity, kInfinity, 5e-7f, kInfinity});
  EXPECT_EQ(count_differing(Question::closest, a, a, 0, 6, 1), 0u);
  EXPECT_EQ(count_differing(Question::closest, a, b, 0, 6, 1), 2u);
  EXPECT_EQ(count_differing(Question::closest, a, b, 0, 6, 0), 3u) << "a scene without size has no tolerance";
  EXPECT_EQ(count_differing(Question::closest, a, b, 2, 1, 1), 0u) << "one ray of them alone";
}

TEST(CompareAnswers, CountsAndHitsHaveToBeTheSame) {
  Answers a(Question::count, 3), b(Question::count, 3);
  a.count = {0, 2, 4};
  b.count = {0, 3, 4};
  EXPECT_EQ(count_differing(Question::count, a, b, 0, 3, 1), 1u);
  Answers c(Question::any, 3), d(Question::any, 3);
  c.hit = {1, 0, 1};
  d.hit = {1, 1, 0};
  EXPECT_EQ(count_differing(Question::any, c, d, 0, 3, 1), 2u);
}

TEST(CompareAnswers, AllHitsAreHeldAgainstEachOtherRayByRay) {
  Answers a(Question::all, 3), b(Question::all, 3);
  a.all.splits = {0, 2, 3, 3};
  a.all.t = {1, 2, 5};
  b.all.splits = {0, 2, 2, 3};
  b.all.t = {1, 2.5, 5};
  EXPECT_EQ(count_differing(Question::all, a, a, 0, 3, 1), 0u);
  EXPECT_EQ(count_differing(Question::all, a, b, 0, 3, 1), 3u);
}

}  // namespace
}  // namespace kdray::bench
