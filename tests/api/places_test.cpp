// Queries on several queues: the answers are those of one queue, bit for bit and in the rays' order,
// whichever queue has given them; and of several invalid rays the first is named.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "kdray/kdray.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray {
namespace {

using test::fails;

constexpr unsigned kSeed = 40;
// More than one place takes at a time, and no round number.
constexpr std::size_t kRays = 150'001;

class Places : public test::EachDevice {
 protected:
  // Triangles in the unit cube and around it, some of which rays don't see.
  Scene soup(int queues) const {
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<float> anywhere(-1, 1);
    Scene scene;
    for (const std::uint32_t mask : {1u, 3u}) {
      std::vector<float> vertices;
      std::vector<std::uint32_t> triangles;
      for (std::uint32_t i = 0; i < 300; ++i) {
        triangles.push_back(i);
        for (int k = 0; k < 3; ++k) vertices.push_back(anywhere(random));
      }
      scene.add_mesh({vertices, triangles}, {.mask = mask});
    }
    CommitOptions options;
    options.device.device = GetParam();
    options.device.queues = queues;
    scene.commit(options);
    return scene;
  }
};
KDRAY_FOR_EACH_DEVICE(Places);

template <class Real>
struct RandomRays {
  std::vector<Real> origins, directions;
  std::vector<std::uint32_t> masks;

  RandomRays() {
    std::mt19937 random(kSeed + 1);
    std::uniform_real_distribution<Real> anywhere(-1, 1);
    for (std::size_t i = 0; i < kRays; ++i) {
      for (int k = 0; k < 3; ++k) origins.push_back(anywhere(random));
      for (int k = 0; k < 3; ++k) directions.push_back(anywhere(random));
      masks.push_back(static_cast<std::uint32_t>(1 + i % 3));
    }
  }
  Rays rays() const { return {.origins = origins, .directions = directions, .masks = masks}; }
};

struct Answers {
  std::vector<double> t = std::vector<double>(kRays);
  std::vector<std::uint32_t> primitive = std::vector<std::uint32_t>(kRays), counts = primitive;
  std::vector<std::uint8_t> any = std::vector<std::uint8_t>(kRays), inside = any;
  std::vector<double> distance = t, with_sign = t;
  AllHits all;
  std::uint64_t invalid = 0;
};

template <class Real>
Answers answers_of(const Scene& scene, const RandomRays<Real>& asked) {
  Answers a;
  const QueryOptions options{.invalid = InvalidRays::miss};
  a.invalid += scene.closest(asked.rays(), {.t = a.t, .primitive = a.primitive}, options).invalid;
  a.invalid += scene.any(asked.rays(), a.any, options).invalid;
  a.invalid += scene.count(asked.rays(), a.counts, options).invalid;
  a.all = scene.all(asked.rays(), {options});
  const PointOptions of_points{.invalid = InvalidRays::miss};
  a.invalid += scene.closest_points(asked.origins, {.distance = a.distance}, of_points).invalid;
  a.invalid += scene.inside(asked.origins, a.inside, of_points).invalid;
  a.invalid += scene.signed_distance(asked.origins, a.with_sign, of_points).invalid;
  return a;
}

template <class T>
void expect_bits(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(
      std::equal(a.begin(), a.end(), b.begin(), [](T x, T y) { return x == y || (x != x && y != y); }))
      << "seed " << kSeed;
}

void expect_same(const Answers& a, const Answers& b) {
  expect_bits(a.t, b.t);
  expect_bits(a.primitive, b.primitive);
  expect_bits(a.any, b.any);
  expect_bits(a.counts, b.counts);
  expect_bits(a.inside, b.inside);
  expect_bits(a.distance, b.distance);
  expect_bits(a.with_sign, b.with_sign);
  EXPECT_EQ(a.all.splits, b.all.splits);
  EXPECT_EQ(a.all.t, b.all.t);
  EXPECT_EQ(a.all.primitive, b.all.primitive);
  EXPECT_EQ(a.all.geometry, b.all.geometry);
  EXPECT_EQ(a.all.more, b.all.more);
  EXPECT_EQ(a.all.report.invalid, b.all.report.invalid);
  EXPECT_EQ(a.invalid, b.invalid);
}

template <class Real>
void expect_queues_agree(const Scene& one, const Scene& several) {
  RandomRays<Real> asked;
  for (const std::size_t bad : {std::size_t{3}, kRays / 2, kRays - 1})
    asked.origins[3 * bad] = std::numeric_limits<Real>::quiet_NaN();
  const Answers expected = answers_of(one, asked);
  EXPECT_EQ(expected.invalid, 18u) << "three of each query";
  EXPECT_GT(expected.all.t.size(), kRays);
  expect_same(expected, answers_of(several, asked));
}

TEST_P(Places, QueuesAnswerAsOneDoes) {
  const Scene one = soup(1);
  for (const int queues : {2, 3}) {
    SCOPED_TRACE(queues);
    const Scene several = soup(queues);
    expect_queues_agree<float>(one, several);
    expect_queues_agree<double>(one, several);
  }
}

TEST_P(Places, OfSeveralInvalidRaysTheFirstIsNamed) {
  const Scene scene = soup(2);
  RandomRays<float> asked;
  for (const std::size_t bad : {std::size_t{40'000}, std::size_t{90'000}, kRays - 1})
    asked.directions[3 * bad + 1] = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> t(kRays);
  std::vector<std::uint32_t> counts(kRays);
  EXPECT_TRUE(fails([&] { scene.closest(asked.rays(), {.t = t}); }, "ray 40000:"));
  EXPECT_TRUE(fails([&] { scene.count(asked.rays(), counts); }, "ray 40000:"));
  EXPECT_TRUE(fails([&] { static_cast<void>(scene.all(asked.rays())); }, "ray 40000:"));
}

// Only the caller's thread may be asked; and the scene serves on.
TEST_P(Places, ACancelledCallEndsOnAllQueues) {
  const Scene scene = soup(2);
  const RandomRays<float> asked;
  std::vector<std::uint32_t> counts(kRays), again(kRays);
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<bool> by_others{false};
  const Cancel cancel([&] {
    if (std::this_thread::get_id() != caller) by_others = true;
    return true;
  });
  const auto is_refused = [&](const auto& ask) { return fails(ask, "cancelled", ErrorCode::cancelled); };
  EXPECT_TRUE(is_refused([&] { static_cast<void>(scene.all(asked.rays(), {{.cancel = cancel}})); }));
  EXPECT_TRUE(is_refused([&] { scene.closest(asked.rays(), {.primitive = counts}, {.cancel = cancel}); }));
  EXPECT_FALSE(by_others);
  scene.count(asked.rays(), counts);
  scene.count(asked.rays(), again);
  EXPECT_EQ(counts, again);
}

// Frames and queries take turns on the same devices, from several threads.
TEST_P(Places, ASceneIsAskedAndRenderedAtOnce) {
  const Scene scene = soup(2);
  const RandomRays<float> asked;
  std::vector<std::uint32_t> expected(kRays), counts(kRays);
  scene.count(asked.rays(), expected);
  RenderOptions options;
  options.width = options.height = 64;
  const Picture alone = scene.render(options);
  Picture beside;
  std::thread rendering([&] { beside = scene.render(options); });
  scene.count(asked.rays(), counts);
  rendering.join();
  EXPECT_EQ(counts, expected);
  EXPECT_EQ(beside.rgb, alone.rgb);
}

}  // namespace
}  // namespace kdray
