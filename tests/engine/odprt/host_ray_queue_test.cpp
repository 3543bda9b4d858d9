// What    HostRayQueue: rays come out as they were put in, by slice, and their number and depth are known.
#include "engine/odprt/outbox.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

namespace kdray::test {
namespace {

using odprt::HostRayQueue;

// All rays, whatever part they go to.
void put_rays(HostRayQueue& host_rays, std::size_t slice, const std::vector<float>& rays,
              std::size_t capacity, std::size_t n) {
  odprt::sort_rays(rays.data(), capacity, n, slice, [&](std::uint32_t) { return &host_rays; });
}

constexpr std::size_t kCapacity = 48;

// Ray i has i + 100*field in each field, and its depth above the finder.
std::vector<float> stream(std::uint32_t n_fields, std::uint32_t depth) {
  std::vector<float> words(n_fields * kCapacity);
  for (std::uint32_t f = 0; f < n_fields; ++f)
    for (std::size_t i = 0; i < kCapacity; ++i) words[f * kCapacity + i] = static_cast<float>(i + 100 * f);
  for (std::size_t i = 0; i < kCapacity; ++i)
    words[KDRAY_RAY_FINDER * kCapacity + i] = std::bit_cast<float>(KDRAY_FINDER(KDRAY_NO_PART, depth));
  return words;
}

TEST(HostRayQueue, RaysComeOutAsTheyWentIn) {
  HostRayQueue host_rays(2, KDRAY_TRAVEL_RAY_FIELDS);
  const std::vector<float> rays = stream(KDRAY_TRAVEL_RAY_FIELDS, 3);
  put_rays(host_rays, 1, rays, kCapacity, 20);
  odprt::sort_shadow_rays(stream(KDRAY_SENT_SHADOW_FIELDS, 0).data(), kCapacity, 7, 1,
                          [&](std::uint32_t) { return &host_rays; });
  EXPECT_EQ(host_rays.n, 27u);
  EXPECT_EQ(host_rays.deepest, 3u);
  EXPECT_EQ(host_rays.rays[0].size(), 0u);
  std::vector<float> out(KDRAY_TRAVEL_RAY_FIELDS * kCapacity);
  std::multiset<float> first_fields;
  while (host_rays.rays[1].size() > 0) {
    const std::size_t n = std::min<std::size_t>(host_rays.rays[1].size(), 6);
    host_rays.rays[1].take(out.data(), kCapacity, 2, n);
    for (std::size_t i = 2; i < 2 + n; ++i) {
      first_fields.insert(out[i]);
      for (std::uint32_t f = 1; f < KDRAY_TRAVEL_RAY_FIELDS; ++f)
        if (f != KDRAY_RAY_FINDER) {
          EXPECT_EQ(out[f * kCapacity + i], out[i] + 100 * f);
        }
    }
  }
  std::multiset<float> expected;
  for (int i = 0; i < 20; ++i) expected.insert(static_cast<float>(i));
  EXPECT_EQ(first_fields, expected);
}

// Ray i goes to part i % 3, of which the second's is not taken.
TEST(HostRayQueue, RaysAreSortedByTheirParts) {
  std::vector<float> rays = stream(KDRAY_TRAVEL_RAY_FIELDS, 2), shadow = stream(KDRAY_SENT_SHADOW_FIELDS, 0);
  for (std::uint32_t i = 0; i < 20; ++i) {
    float& word = rays[KDRAY_RAY_FINDER * kCapacity + i];
    word = std::bit_cast<float>(KDRAY_FINDER_TO(std::bit_cast<std::uint32_t>(word), i % 3));
    shadow[KDRAY_SENT_SHADOW_TO * kCapacity + i] = std::bit_cast<float>(i % 3);
  }
  std::vector<HostRayQueue> host_rays(3, HostRayQueue(2, KDRAY_TRAVEL_RAY_FIELDS));
  const auto host_rays_of = [&](std::uint32_t part) { return part == 1 ? nullptr : &host_rays.at(part); };
  odprt::sort_rays(rays.data(), kCapacity, 20, 0, host_rays_of);
  odprt::sort_shadow_rays(shadow.data(), kCapacity, 20, 1, host_rays_of);
  EXPECT_EQ(host_rays[0].rays[0].size(), 7u);
  EXPECT_EQ(host_rays[0].n_rays(), 7u);
  EXPECT_EQ(host_rays[0].shadow_rays[1].size(), 7u);
  EXPECT_EQ(host_rays[1].n, 0u);
  EXPECT_EQ(host_rays[2].n, 12u);
  EXPECT_EQ(host_rays[2].deepest, 2u) << "the part is above the depth";
  std::vector<float> out(KDRAY_SENT_SHADOW_FIELDS * kCapacity);
  host_rays[2].shadow_rays[1].take(out.data(), kCapacity, 0, 6);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(static_cast<int>(out[i]) % 3, 2);
}

TEST(HostRayQueue, PooledRaysGetTheirDepth) {
  HostRayQueue host_rays(1, KDRAY_TRAVEL_RAY_FIELDS);
  std::vector<float> pool = stream(KDRAY_TRAVEL_RAY_FIELDS, 0);
  host_rays.put_pooled_rays(0, pool.data(), kCapacity, 5, 4);
  EXPECT_EQ(host_rays.deepest, 4u);
  std::vector<float> out(KDRAY_TRAVEL_RAY_FIELDS * kCapacity);
  host_rays.rays[0].take(out.data(), kCapacity, 0, 5);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(std::bit_cast<std::uint32_t>(out[KDRAY_RAY_FINDER * kCapacity + i]),
              KDRAY_FINDER(KDRAY_NO_PART, 4u));
}

TEST(HostRayQueue, TakingAllMovesAndEmpties) {
  HostRayQueue a(2, KDRAY_TRAVEL_RAY_FIELDS), b(2, KDRAY_TRAVEL_RAY_FIELDS);
  const std::vector<float> rays = stream(KDRAY_TRAVEL_RAY_FIELDS, 2);
  put_rays(a, 0, rays, kCapacity, 3);
  put_rays(b, 0, rays, kCapacity, 4);
  put_rays(b, 1, rays, kCapacity, 5);
  a.take_all(b);
  EXPECT_EQ(a.n, 12u);
  EXPECT_EQ(a.rays[0].size(), 7u);
  EXPECT_EQ(a.rays[1].size(), 5u);
  EXPECT_EQ(a.deepest, 2u);
  EXPECT_EQ(b.n, 0u);
  EXPECT_EQ(b.deepest, 0u);
  EXPECT_EQ(b.rays[0].size() + b.rays[1].size(), 0u);
}

}  // namespace
}  // namespace kdray::test
