// What    Both sides of `kdray bench queries` answer the same questions alike: Embree's filters count and
//         list every crossing, and its nearest points are the nearest. Skipped without Embree.
#include <gtest/gtest.h>

#include <random>

#include "apps/cli/program.h"
#include "bench/embree/embree.h"
#include "bench/queries/bench.h"
#include "bench/race/compare.h"

namespace kdray::bench {
namespace {

constexpr unsigned kSeed = 1;

// Triangles all over the place, none of which share an edge: there Embree counts some crossings twice.
MeshArrays lump() {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> anywhere(-10, 10), near(-1, 1);
  MeshArrays mesh;
  for (std::uint32_t i = 0; i < 3000; i += 3) {
    const float at[3] = {anywhere(random), anywhere(random), anywhere(random)};
    for (int corner = 0; corner < 3; ++corner)
      for (const float x : at) mesh.vertices.push_back(x + near(random));
    mesh.triangles.insert(mesh.triangles.end(), {i, i + 1, i + 2});
  }
  return mesh;
}

QuerySet rays(std::size_t n) {
  std::mt19937 random(kSeed + 1);
  std::uniform_real_distribution<float> anywhere(-12, 12);
  QuerySet set{"random", {}, {}, {}};
  for (std::size_t i = 0; i < 3 * n; ++i) {
    set.origins.push_back(anywhere(random));
    set.directions.push_back(anywhere(random));
    set.points.push_back(anywhere(random));
  }
  return set;
}

TEST(BenchQueries, SidesAnswerAlike) {
  if (embree_versions().empty()) GTEST_SKIP() << "no Embree is found";
  KDRAY_NEED_DEVICE();
  const MeshArrays mesh = lump();
  const QuerySet set = rays(3001);  // no whole number of packets or grains
  const auto scene = std::make_shared<const Scene>(kdray_scene(mesh, {}));
  const Side kdray = kdray_side(scene, mesh, {});
  const std::vector<Side> sides = embree_sides(mesh, 2);
  ASSERT_EQ(sides.size(), 2u);
  for (const std::string_view name : question_names()) {
    const Question question = question_of(name);
    if (!embree_answers(question)) continue;
    Answers expected(question, set.size());
    kdray.forms.front().asker->ask(question, set, 1, 3000, expected);
    for (const Side& side : sides)
      for (const Side::Form& form : side.forms) {
        Answers answers(question, set.size());
        form.asker->ask(question, set, 1, 3000, answers);
        EXPECT_LE(count_differing(question, expected, answers, 1, 3000, 20), 3u)
            << "seed " << kSeed << ": " << name << ", " << side.name << " " << form.name;
      }
  }
}

TEST(BenchQueries, CountsAreTheLengthsOfLists) {
  if (embree_versions().empty()) GTEST_SKIP() << "no Embree is found";
  const MeshArrays mesh = lump();
  const QuerySet set = rays(2000);
  for (const Side& side : embree_sides(mesh, 2))
    for (const Side::Form& form : side.forms) {
      Answers count(Question::count, set.size()), all(Question::all, set.size());
      form.asker->ask(Question::count, set, 0, set.size(), count);
      form.asker->ask(Question::all, set, 0, set.size(), all);
      ASSERT_EQ(all.all.splits.size(), set.size() + 1);
      ASSERT_GT(all.all.t.size(), 300u);
      for (std::size_t i = 0; i < set.size(); ++i) {
        const std::size_t first = all.all.splits[i], end = all.all.splits[i + 1];
        ASSERT_EQ(count.count[i], end - first) << form.name << ", ray " << i;
        ASSERT_TRUE(std::is_sorted(&all.all.t[0] + first, &all.all.t[0] + end)) << form.name << ", ray " << i;
      }
    }
}

}  // namespace
}  // namespace kdray::bench
