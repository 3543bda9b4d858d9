// What    The race between contestants of known times: interleaved, warmed up, the best variant kept, hits
//         compared.
#include "bench/race/race.h"

#include <gtest/gtest.h>

#include <string>

namespace kdray::bench {
namespace {

const std::vector<Hit> kReference = {{1, 0, 0, 0}, {2, 1, 0, 0}};

struct Recorder {
  std::vector<std::string> runs;

  Contestant contestant(Family family, const std::string& mode,
                        std::vector<std::pair<std::string, double>> variants,
                        const std::vector<Hit>& hits = kReference) {
    Contestant c{family, mode, {}};
    for (const auto& [name, seconds] : variants)
      c.variants.push_back({name, [this, mode, hits, name = name, seconds = seconds](const RayClass&) {
                              runs.push_back(mode + name);
                              return Traced{seconds, hits};
                            }});
    return c;
  }
};

TEST(Race, WarmsUpThenTakesTurns) {
  Recorder r;
  const std::vector<Contestant> all = {r.contestant(Family::kdray, "a", {{"", 1.0}}),
                                       r.contestant(Family::embree_fast, "b", {{"1", 3.0}, {"2", 2.0}})};
  const std::vector<Outcome> outcomes = race({"", false, std::vector<Ray>(2)}, kReference, all, 2);
  EXPECT_EQ(r.runs, (std::vector<std::string>{"a", "a", "b1", "b1", "b2", "b2", "a", "b2", "a", "b2"}));
  ASSERT_EQ(outcomes.size(), 2u);
  EXPECT_EQ(outcomes[1].variant, "2");
  EXPECT_EQ(outcomes[1].seconds.median, 2);
  EXPECT_EQ(outcomes[0].n_not_identical, 0u);
}

TEST(Race, WarmsUpOnceForOneRound) {
  Recorder r;
  race({"", false, std::vector<Ray>(2)}, kReference, {r.contestant(Family::kdray, "a", {{"", 1.0}})}, 1);
  EXPECT_EQ(r.runs, (std::vector<std::string>{"a", "a"}));
}

TEST(Race, ComparesHits) {
  std::vector<Hit> other = kReference;
  other[1] = {5, 3, 0, 0};
  Recorder r;
  const std::vector<Outcome> outcomes = race({"", false, std::vector<Ray>(2)}, kReference,
                                             {r.contestant(Family::kdray, "a", {{"", 1.0}}, other),
                                              r.contestant(Family::embree_robust, "b", {{"", 1.0}}, other)},
                                             1);
  EXPECT_EQ(outcomes[0].n_not_identical, 1u);
  EXPECT_EQ(outcomes[1].n_not_identical, 0u);  // others need not give the same bits
  EXPECT_EQ(outcomes[1].differing_share, 0.5);
}

// One that has hits of its own to be held against, as another scene's has.
TEST(Race, ComparesHitsWithTheContestantsOwnReference) {
  std::vector<Hit> other = kReference;
  other[1] = {5, 3, 0, 0};
  Recorder r;
  Contestant own = r.contestant(Family::kdray, "a", {{"", 1.0}}, other);
  own.reference = other;
  const std::vector<Outcome> outcomes = race({"", false, std::vector<Ray>(2)}, kReference,
                                             {own, r.contestant(Family::kdray, "b", {{"", 1.0}}, other)}, 1);
  EXPECT_EQ(outcomes[0].n_not_identical, 0u);
  EXPECT_EQ(outcomes[1].n_not_identical, 1u);
}

TEST(Race, FindsTheBest) {
  Recorder r;
  const std::vector<Outcome> outcomes = race(
      {"", false, std::vector<Ray>(2)}, kReference,
      {r.contestant(Family::kdray, "wide", {{"", 3.0}}), r.contestant(Family::kdray, "auto", {{"", 1.0}}),
       r.contestant(Family::kdray, "batch", {{"", 2.0}}),
       r.contestant(Family::embree_fast, "8", {{"", 4.0}})},
      1);
  EXPECT_EQ(best_of(outcomes, Family::kdray)->mode, "auto");
  EXPECT_EQ(best_fixed(outcomes)->mode, "batch");
  EXPECT_EQ(find(outcomes, Family::embree_fast, "8")->seconds.median, 4);
  EXPECT_EQ(best_of(outcomes, Family::embree_robust), nullptr);
}

}  // namespace
}  // namespace kdray::bench
