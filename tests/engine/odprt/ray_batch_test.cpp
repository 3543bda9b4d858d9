// Rays as a message: what comes out is what went in, for any size of messages; and bytes from a broken or
// hostile rank are refused, each with a word changed.
#include "engine/odprt/ray_batch.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <numeric>
#include <random>

#include "kdray/error.h"

namespace kdray::odprt {
namespace {

constexpr std::uint32_t kSlices = 3, kDepth = 4;
const RaysKnown kKnown{.first_part = 2,
                       .n_parts = 2,
                       .n_all_parts = 5,
                       .n_slices = kSlices,
                       .ray_fields = KDRAY_TRAVEL_RAY_FIELDS,
                       .max_depth = kDepth,
                       .first_pixel = 100,
                       .n_pixels = 50};

float as_float(std::uint32_t word) {
  return std::bit_cast<float>(word);
}

std::vector<HostRayQueue> some_host_rays(unsigned seed, int n) {
  std::mt19937 random(seed);
  std::vector<HostRayQueue> host_rays(2, HostRayQueue(kSlices, KDRAY_TRAVEL_RAY_FIELDS));
  for (int i = 0; i < n; ++i) {
    float ray[KDRAY_TRAVEL_RAY_FIELDS];
    for (float& word : ray) word = static_cast<float>(random() % 1000);
    const auto up_to = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    const std::uint32_t pixel = 100 + up_to(50), part = up_to(2), slice = up_to(kSlices);
    if (random() % 2 == 0) {
      ray[KDRAY_RAY_PIXEL] = as_float(pixel);
      ray[KDRAY_RAY_FINDER] = as_float(KDRAY_FINDER_TO(KDRAY_FINDER(up_to(5), 1 + up_to(kDepth)), part + 2));
      host_rays[part].put_ray(slice, ray, 1, 0);
    } else {
      ray[KDRAY_SHADOW_PIXEL] = as_float(pixel);
      host_rays[part].put_shadow_ray(slice, ray, 1, 0);
    }
  }
  return host_rays;
}

transport::Message message_of(transport::Bytes bytes) {
  return {.from = 1, .tag = 96, .bytes = std::move(bytes)};
}

// The words of all rays of a pile, in a defined order.
template <class Pile>
std::vector<std::vector<float>> sorted(const Pile& pile, std::size_t n_fields) {
  std::vector<std::vector<float>> rays;
  const std::span<const float> words = pile.last(pile.size());
  for (std::size_t i = 0; i < pile.size(); ++i) {
    const auto ray = words.subspan(i * n_fields, n_fields);
    rays.emplace_back(ray.begin(), ray.end());
  }
  const auto bits = [](float a) { return std::bit_cast<std::uint32_t>(a); };
  std::ranges::sort(rays, [&](const auto& a, const auto& b) {
    return std::ranges::lexicographical_compare(a, b, {}, bits, bits);
  });
  return rays;
}

TEST(RayBatchTest, ComesOutAsItWentIn) {
  for (const std::size_t most : {std::size_t{1}, std::size_t{500}, std::size_t{1} << 20}) {
    const std::vector<HostRayQueue> reference = some_host_rays(7, 200);
    std::vector<HostRayQueue> from = some_host_rays(7, 200),
                              to(2, HostRayQueue(kSlices, KDRAY_TRAVEL_RAY_FIELDS));
    std::vector<std::uint32_t> sent(kKnown.n_counts()), come(kKnown.n_counts());
    int n_messages = 0;
    while (from[0].n + from[1].n > 0) {
      ASSERT_LE(++n_messages, 400);
      unpack_rays(message_of(pack_rays(9, 2, from, most, sent)), kKnown, to, come);
    }
    EXPECT_EQ(sent, come);
    EXPECT_EQ(std::accumulate(sent.begin(), sent.end(), 0u), 200u);
    for (std::size_t p = 0; p < 2; ++p) {
      EXPECT_EQ(to[p].n, reference[p].n);
      EXPECT_EQ(to[p].deepest, reference[p].deepest);
      for (std::size_t s = 0; s < kSlices; ++s) {
        EXPECT_EQ(sorted(to[p].rays[s], KDRAY_TRAVEL_RAY_FIELDS),
                  sorted(reference[p].rays[s], KDRAY_TRAVEL_RAY_FIELDS));
        EXPECT_EQ(sorted(to[p].shadow_rays[s], KDRAY_TRAVEL_SHADOW_FIELDS),
                  sorted(reference[p].shadow_rays[s], KDRAY_TRAVEL_SHADOW_FIELDS));
      }
    }
  }
}

bool is_refused(transport::Bytes bytes) {
  std::vector<HostRayQueue> to(2, HostRayQueue(kSlices, KDRAY_TRAVEL_RAY_FIELDS));
  std::vector<std::uint32_t> counts(kKnown.n_counts());
  try {
    unpack_rays(message_of(std::move(bytes)), kKnown, to, counts);
  } catch (const Error&) {
    return true;
  }
  return false;
}

TEST(RayBatchTest, RefusesWhatKernelsCouldNotTake) {
  std::vector<HostRayQueue> host_rays(2, HostRayQueue(kSlices, KDRAY_TRAVEL_RAY_FIELDS));
  float ray[KDRAY_TRAVEL_RAY_FIELDS] = {};
  ray[KDRAY_RAY_PIXEL] = as_float(149);
  ray[KDRAY_RAY_FINDER] = as_float(KDRAY_FINDER(KDRAY_NO_PART, 4u));
  host_rays[1].put_ray(2, ray, 1, 0);
  std::vector<std::uint32_t> counts(kKnown.n_counts());
  const transport::Bytes good = pack_rays(9, 2, host_rays, 1 << 20, counts);
  EXPECT_FALSE(is_refused(good));
  for (std::size_t n = 0; n < good.size(); ++n) EXPECT_TRUE(is_refused(good.substr(0, n))) << n;
  EXPECT_TRUE(is_refused(good + "1234"));
  const auto with = [&](std::size_t word, std::uint32_t value) {
    transport::Bytes bytes = good;
    std::memcpy(&bytes[4 * word], &value, 4);
    return bytes;
  };
  constexpr std::size_t kPile = 2, kRay = 6;
  EXPECT_TRUE(is_refused(with(1, 2)));      // piles
  EXPECT_TRUE(is_refused(with(kPile, 1)));  // another rank's part
  EXPECT_TRUE(is_refused(with(kPile, 4)));
  EXPECT_TRUE(is_refused(with(kPile + 1, 3)));  // slices
  EXPECT_TRUE(is_refused(with(kPile + 2, 2)));  // rays
  EXPECT_TRUE(is_refused(with(kPile + 2, 0xffffffffu)));
  EXPECT_TRUE(is_refused(with(kPile + 3, 0xffffffffu)));
  EXPECT_TRUE(is_refused(with(kRay + KDRAY_RAY_PIXEL, 99)));
  EXPECT_TRUE(is_refused(with(kRay + KDRAY_RAY_PIXEL, 150)));
  EXPECT_TRUE(is_refused(with(kRay + KDRAY_RAY_FINDER, KDRAY_FINDER(5u, 1u))));
  EXPECT_TRUE(is_refused(with(kRay + KDRAY_RAY_FINDER, KDRAY_FINDER(1u, 0u))));
  EXPECT_TRUE(is_refused(with(kRay + KDRAY_RAY_FINDER, KDRAY_FINDER(1u, 5u))));
}

}  // namespace
}  // namespace kdray::odprt
