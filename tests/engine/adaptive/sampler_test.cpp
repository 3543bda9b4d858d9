// Rounds over pictures of closed form, sampled here without a device: what is refined, how good the picture
// and the belief about its error are, and that lists are what the kernels expect.
#include "engine/adaptive/sampler.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>

namespace kdray::adaptive {
namespace {

constexpr Size kPictureSize{100, 75};

using Function = std::function<double(double x, double y)>;  // in pixels

double half_plane(double x, double y) {
  return 0.3 * x + y > 50 ? 0.9 : 0.1;
}

// Sample k of a pixel: the centre, then Sobol' points from there on, shifted by a random number of the
// pixel's own.
struct Point {
  double x, y;
};
Point point_of(std::uint32_t pixel, std::uint32_t k) {
  if (k == 0) return {0.5, 0.5};
  std::minstd_rand engine(pixel + 1);  // the seed is the pixel
  engine.discard(3);
  const auto shift_x = static_cast<std::uint32_t>(engine()) << 1,
             shift_y = static_cast<std::uint32_t>(engine()) << 1;
  std::uint32_t x = 0, y = 0, v = 1u << 31;
  for (std::uint32_t i = 0; i < 32; ++i, v ^= v >> 1) {
    if (!(k >> i & 1)) continue;
    x ^= 1u << (31 - i);
    y ^= v;
  }
  return {(x ^ shift_x) * 0x1p-32, (y ^ shift_y) * 0x1p-32};
}

layout::i64 units(double value) {
  return std::llround(value * static_cast<double>(KDRAY_FILM_SCALE));
}

struct Outcome {
  std::vector<float> picture;
  Report report;
};

Outcome sample(const Function& f, double target, bool noisy = false) {
  Sampler sampler(kPictureSize, target, noisy);
  const auto value = [&](std::uint32_t x, std::uint32_t y, std::uint32_t k) {
    const Point p = point_of(y * kPictureSize.width + x, k);
    return units(f(x + p.x, y + p.y));
  };
  for (std::size_t i = 0; i < sampler.first_sums().size(); ++i)
    sampler.first_sums()[i] = value(static_cast<std::uint32_t>(i / 3) % kPictureSize.width,
                                    static_cast<std::uint32_t>(i / 3) / kPictureSize.width, 0);
  std::map<layout::u32, std::uint32_t> counts;  // by entry, of pixels that were refined
  for (auto list = sampler.next(); !list.empty(); list = sampler.next()) {
    EXPECT_EQ(list.size() % (2 * KDRAY_SAMPLE_RUN), 0u);
    std::vector<layout::i64> sums(list.size() / 2 * 3);
    bool ended = false;
    for (std::size_t i = 0; i < list.size() / 2; ++i) {
      const std::size_t at = i / KDRAY_SAMPLE_RUN * 2 * KDRAY_SAMPLE_RUN + i % KDRAY_SAMPLE_RUN;
      ended = ended || list[at] == KDRAY_NO_SAMPLE;
      EXPECT_EQ(ended, list[at] == KDRAY_NO_SAMPLE) << "only the end is filled up";
      if (ended) continue;
      std::uint32_t& next = counts.try_emplace(list[at], 1u).first->second;
      EXPECT_EQ(list[at + KDRAY_SAMPLE_RUN], next++) << "the pixel's sequence, without gaps";
      const layout::i64 v = value(KDRAY_TILE_COLUMN(list[at]), KDRAY_TILE_ROW(list[at]), next - 1);
      for (int c = 0; c < 3; ++c) sums[3 * i + static_cast<std::size_t>(c)] = v;
    }
    sampler.take(sums);
  }
  const Report report = sampler.report();
  for (const auto& [entry, n] : counts)
    EXPECT_EQ(report.counts[KDRAY_TILE_ROW(entry) * kPictureSize.width + KDRAY_TILE_COLUMN(entry)],
              static_cast<float>(n));
  return {sampler.picture(), report};
}

// Against 16x16 samples of each pixel.
double error_of(const std::vector<float>& picture, const Function& f) {
  double squares = 0;
  for (std::uint32_t y = 0; y < kPictureSize.height; ++y)
    for (std::uint32_t x = 0; x < kPictureSize.width; ++x) {
      double mean = 0;
      for (int i = 0; i < 256; ++i) mean += f(x + (i % 16 + 0.5) / 16, y + (i / 16 + 0.5) / 16) / 256;
      const double d = static_cast<double>(picture[3 * (y * kPictureSize.width + x)]) - mean;
      squares += d * d;
    }
  return std::sqrt(squares / static_cast<double>(kPictureSize.pixels()));
}

std::vector<float> uniform(const Function& f, std::uint32_t n) {
  std::vector<float> picture(3 * kPictureSize.pixels());
  for (std::uint32_t pixel = 0; pixel < kPictureSize.pixels(); ++pixel) {
    double sum = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
      const Point p = point_of(pixel, k);
      sum += f(pixel % kPictureSize.width + p.x, pixel / kPictureSize.width + p.y);
    }
    std::fill_n(picture.begin() + 3 * pixel, 3, static_cast<float>(sum / n));
  }
  return picture;
}

TEST(Sampler, AFlatPictureTakesOneSamplePerPixel) {
  const Outcome flat = sample([](double, double) { return 0.4; }, 1e-6);
  EXPECT_EQ(flat.report.samples, kPictureSize.pixels());
  EXPECT_EQ(flat.report.rounds, 1);
  EXPECT_EQ(flat.report.estimated_rmse, 0);
  EXPECT_TRUE(flat.report.met);
}

TEST(Sampler, AnEdgeIsRefinedAndNothingElse) {
  const Outcome edge = sample(half_plane, 0.003);
  EXPECT_TRUE(edge.report.met);
  for (std::uint32_t y = 0; y < kPictureSize.height; ++y)
    for (std::uint32_t x = 0; x < kPictureSize.width; ++x)
      if (std::abs(0.3 * x + y - 50) > 4) {
        EXPECT_EQ(edge.report.counts[y * kPictureSize.width + x], 1) << x << " " << y;
      }
  const auto per_pixel =
      static_cast<double>(edge.report.samples) / static_cast<double>(kPictureSize.pixels());
  EXPECT_LT(per_pixel, 3);
  EXPECT_LT(error_of(edge.picture, half_plane), 0.5 * error_of(uniform(half_plane, 4), half_plane));
}

// Each pixel is lit in some of its samples, by chance: an even picture of one grey, of which one sample in
// each pixel tells little.
TEST(Sampler, NoiseGetsFourSamplesInEachPixelAtLeast) {
  constexpr double kShare = 0.9;
  const Function noise = [](double x, double y) {
    std::minstd_rand engine(static_cast<unsigned>(x * 7919) * 31 + static_cast<unsigned>(y * 6007) + 1);
    engine.discard(5);
    return std::uniform_real_distribution<double>()(engine) < kShare ? 1.0 : 0.0;
  };
  const Outcome o = sample(noise, 0.1, true);
  EXPECT_EQ(o.report.pixels[0], 0u);
  double sum = 0;
  for (const float value : o.picture) sum += (value - kShare) * (value - kShare) / 3;
  EXPECT_LT(std::sqrt(sum / static_cast<double>(kPictureSize.pixels())), 0.2);
  const Outcome flat = sample([](double, double) { return 0.4; }, 1e-6, true);
  EXPECT_EQ(flat.report.samples, 4 * kPictureSize.pixels());
  EXPECT_TRUE(flat.report.met);
}

TEST(Sampler, ItsBeliefIsWithinAFactorOfTwo) {
  const std::pair<const char*, Function> pictures[] = {
      {"an edge", half_plane},
      {"a disc", [](double x, double y) { return std::hypot(x - 47.3, y - 33.1) < 25.2 ? 0.8 : 0.2; }},
      {"stripes", [](double x, double y) { return std::fmod(x + 0.37 * y, 7.3) < 2.9 ? 0.7 : 0.3; }},
      {"fine stripes", [](double x, double y) { return std::fmod(x + 0.37 * y, 1.3) < 0.5 ? 1.0 : 0.0; }}};
  for (const auto& [name, f] : pictures)
    for (const double target : {0.02, 0.005, 0.002}) {
      const Outcome o = sample(f, target);
      const double error = error_of(o.picture, f);
      EXPECT_GT(o.report.estimated_rmse, 0.5 * error) << name << " " << target;
      EXPECT_LT(o.report.estimated_rmse, 2 * error) << name << " " << target;
    }
}

TEST(Sampler, TheTargetIsMetOrTheCapSaid) {
  std::mt19937 engine(7);  // seed 7
  std::vector<double> noise(1 << 16);
  for (double& v : noise) v = std::uniform_real_distribution<double>()(engine);
  const Function f = [&](double x, double y) {
    return noise[(static_cast<std::size_t>(x * 61) * 7919 + static_cast<std::size_t>(y * 67)) % noise.size()];
  };
  const Outcome coarse = sample(f, 0.1), fine = sample(f, 1e-4);
  EXPECT_TRUE(coarse.report.met);
  EXPECT_LE(coarse.report.estimated_rmse, 0.1);
  EXPECT_FALSE(fine.report.met);
  EXPECT_GT(fine.report.estimated_rmse, 1e-4);
  EXPECT_GT(fine.report.pixels[kLevels - 1], kPictureSize.pixels() * 9 / 10)
      << "all that could be refined was";
  EXPECT_LT(coarse.report.samples, fine.report.samples);
}

// What lies between the centres can't be known from them: a line that no centre is on isn't found. Where it
// crosses a pixel's centre line somewhere, it is followed from there.
TEST(Sampler, ALineBetweenTheCentresIsFoundWhereOneIsOnIt) {
  const Outcome hidden = sample([](double x, double) { return std::abs(x - 40) < 0.2 ? 1.0 : 0.0; }, 0.001);
  EXPECT_EQ(hidden.report.samples, kPictureSize.pixels());
  const Function slanted = [](double x, double y) { return std::abs(x - 20 - y / 3) < 0.2 ? 1.0 : 0.0; };
  const Outcome seen = sample(slanted, 0.001);
  EXPECT_LT(error_of(seen.picture, slanted), 0.3 * error_of(uniform(slanted, 1), slanted));
}

TEST(Sampler, TheSameBitsOnAnyNumberOfThreads) {
  const Function f = [](double x, double y) {
    return std::fmod(x * x / 90 + y, 5.0) < 2 ? 0.7 : 0.3 + x / 500;
  };
  Outcome one, many;
  tbb::task_arena(1).execute([&] { one = sample(f, 0.004); });
  tbb::task_arena(4).execute([&] { many = sample(f, 0.004); });
  EXPECT_EQ(one.picture, many.picture);
  EXPECT_EQ(one.report.estimated_rmse, many.report.estimated_rmse);
  EXPECT_EQ(one.report.counts, many.report.counts);
}

}  // namespace
}  // namespace kdray::adaptive
