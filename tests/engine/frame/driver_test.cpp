// The driver without a device: an executor that makes up the light of each sample, and leaves entries where
// its time is limited. Whatever bands, capacities, checkpoints and interruptions there are, the picture is
// that of the light, each entry is rendered once, and the progress is what it is to be.
#include "engine/frame/driver.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine/wavefront/random_frame.h"
#include "engine/wavefront/tile_order.h"
#include "support/folder.h"

namespace kdray::frame {
namespace {

using test::Random, test::random_frame;

// Of a sample of a pixel: between 0 and 1. Some pixels are even, others noisy.
layout::i64 light(std::uint32_t x, std::uint32_t y, std::uint32_t sample, std::size_t channel) {
  const std::uint64_t noise = (x / 8 + y / 8) % 2 == 0 ? 0 : sample + 1;
  std::uint64_t h = (x / 8) * 31 + (y / 8) * 977 + noise * 7919 + channel * 104729;
  h = (h ^ (h >> 7)) * 0x9e3779b97f4a7c15u;
  return static_cast<layout::i64>(h >> 28);
}

checkpoint::Cut cut_of(const layout::Frame& frame) {
  return {frame.width, frame.height, frame.tile_width, frame.tile_height};
}

struct Interrupted {};

class Pretender final : public Executor {
 public:
  Pretender(const layout::Frame& frame, std::size_t max_film_bytes, std::size_t n_samples, std::uint64_t seed)
      : frame_(frame),
        bands_(wavefront::bands_of(frame, max_film_bytes)),
        n_samples_(n_samples),
        random_(seed) {}

  const layout::Frame& frame() const override { return frame_; }
  std::span<const wavefront::Band> bands() const override { return bands_; }
  std::size_t n_samples() const override { return n_samples_; }
  bool leads() const override { return !follows; }
  void follow() override { ++n_followed; }

  Entries render(List list, const Sink& sink, const std::function<void(double)>& progress) override {
    if (lists.size() == interrupt_at) throw Interrupted();
    lists.push_back(list);
    check(list);
    progress(0);
    progress(static_cast<double>(list.entries.size()) / 2);
    Entries left;
    if (list.seconds < kForever)
      for (auto n = random_.pick(0, static_cast<std::uint32_t>(list.entries.size() / 2)); n > 0; --n) {
        left.push_back(list.entries.back());
        list.entries.pop_back();
      }
    n_rendered += list.entries.size();
    hand_over(list, sink);
    return left;
  }

  bool follows = false;
  std::size_t interrupt_at = std::size_t(-1);
  std::vector<List> lists;
  std::size_t n_rendered = 0;
  int n_followed = 0;

 private:
  checkpoint::Rectangle places_of(const List& list, layout::u32 entry) const {
    return checkpoint::places_of(cut_of(frame_), list.samples.empty() ? 0 : 1, entry);
  }

  void check(const List& list) const {
    ASSERT_FALSE(list.entries.empty());
    ASSERT_EQ(list.samples.size(), list.samples.empty() ? 0 : 2 * list.n_places);
    ASSERT_LE(list.samples.size(), 2 * n_samples_);
    for (const layout::u32 entry : list.entries) {
      const checkpoint::Rectangle r = places_of(list, entry);
      ASSERT_GT(r.width, 0u) << entry;
      const std::size_t pitch = list.samples.empty() ? frame_.width : 0;
      ASSERT_GE(r.y * pitch + r.x, list.first_place) << entry;
      ASSERT_LE((r.y + r.height - 1) * pitch + r.x + r.width, list.first_place + list.n_places) << entry;
    }
  }

  layout::i64 sum_at(const List& list, std::size_t place, std::size_t channel) const {
    if (list.samples.empty()) {
      const auto x = static_cast<std::uint32_t>(place % frame_.width),
                 y = static_cast<std::uint32_t>(place / frame_.width);
      layout::i64 sum = 0;
      for (std::uint32_t sample = 0; sample < frame_.n_samples; ++sample) sum += light(x, y, sample, channel);
      return sum;
    }
    const std::size_t run = place / KDRAY_SAMPLE_RUN, i = place % KDRAY_SAMPLE_RUN;
    const layout::u32 pixel = list.samples[2 * run * KDRAY_SAMPLE_RUN + i];
    if (pixel == KDRAY_NO_SAMPLE) return 0;
    return light(KDRAY_TILE_COLUMN(pixel), KDRAY_TILE_ROW(pixel),
                 list.samples[(2 * run + 1) * KDRAY_SAMPLE_RUN + i], channel);
  }

  // By two films, of which both have something of each place, those of other entries too; or one by one.
  void hand_over(const List& list, const Sink& sink) {
    std::vector<layout::i64> one(3 * list.n_places), other(3 * list.n_places);
    for (std::size_t i = 0; i < one.size(); ++i) {
      one[i] = random_.sum();
      other[i] = sum_at(list, list.first_place + i / 3, i % 3) - one[i];
    }
    const std::span<const layout::i64> films[] = {one, other};
    Entries by_films;
    for (const layout::u32 entry : list.entries) {
      if (random_.pick(0, 1) == 0) {
        by_films.push_back(entry);
        continue;
      }
      const checkpoint::Rectangle r = places_of(list, entry);
      std::vector<layout::i64> sums;
      for (std::size_t y = r.y; y < r.y + r.height; ++y)
        for (std::size_t x = r.x; x < r.x + r.width; ++x)
          for (std::size_t c = 0; c < 3; ++c)
            sums.push_back(sum_at(list, list.samples.empty() ? y * frame_.width + x : x, c));
      const std::span<const layout::i64> film = sums;
      sink({{&film, 1}, std::size_t{r.y} * r.width + r.x, r.width}, {&entry, 1});
    }
    sink({films, list.first_place, frame_.width}, by_films);
  }

  layout::Frame frame_;
  std::vector<wavefront::Band> bands_;
  std::size_t n_samples_;
  Random random_;
};

// A frame of a seed, and what it is rendered with.
struct Case {
  explicit Case(std::uint64_t seed, double adaptive_target = 0) : seed(seed), random(seed) {
    request.frame = random_frame(random);
    if (adaptive_target > 0) {
      request.frame.n_samples = 1;
      request.adaptive_target = adaptive_target;
    }
    request.progress = [this](double share) { told.push_back(share); };
    row_bytes = std::size_t{request.frame.tile_height} * request.frame.width * 3 * sizeof(layout::i64);
    whole = row_bytes * (request.frame.n_tiles / request.frame.n_tiles_x);
  }

  Pretender executor(std::size_t n_rows, std::size_t n_samples = std::size_t{1} << 20) {
    return Pretender(request.frame, n_rows * row_bytes, n_samples, seed);
  }
  std::uint32_t some_rows() { return random.pick(1, request.frame.n_tiles / request.frame.n_tiles_x); }

  Result render(Pretender& executor) {
    told.clear();
    Result result;
    render_frame(executor, request, result);
    return result;
  }

  // With the checkpoint that is in the folder, or a new one. Nothing: interrupted.
  std::optional<Result> render(Pretender& executor, const LedgerOptions& options) {
    const checkpoint::Identity identity{hash_of("scene"), hash_of("settings"), hash_of("build"), "", ""};
    checkpoint::FrameCheckpoint checkpoint(options, identity, cut_of(request.frame), false, "device");
    request.checkpoint = &checkpoint;
    try {
      return render(executor);
    } catch (const Interrupted&) {
      return std::nullopt;
    }
  }

  std::uint64_t seed;
  Random random;
  Request request;
  std::size_t row_bytes, whole;
  std::vector<double> told;
};

// The mean of the samples, so many of each pixel.
void expect_picture(const Result& result, const layout::Frame& frame, const std::vector<float>& counts) {
  ASSERT_EQ(result.rgb.size(), 3 * std::size_t{frame.width} * frame.height);
  for (std::size_t p = 0; p < result.rgb.size() / 3; ++p)
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(counts[p]); ++i)
        sum += static_cast<double>(light(static_cast<std::uint32_t>(p % frame.width),
                                         static_cast<std::uint32_t>(p / frame.width), i, c));
      ASSERT_NEAR(result.rgb[3 * p + c], sum / (static_cast<double>(KDRAY_FILM_SCALE) * counts[p]), 1e-6)
          << "pixel " << p;
    }
}

void expect_picture(const Result& result, const layout::Frame& frame) {
  expect_picture(
      result, frame,
      std::vector<float>(std::size_t{frame.width} * frame.height, static_cast<float>(frame.n_samples)));
  EXPECT_FALSE(result.samples);
}

class DriverTest : public testing::TestWithParam<int> {
 protected:
  const std::uint64_t seed = static_cast<std::uint64_t>(GetParam());
  const testing::ScopedTrace trace{__FILE__, __LINE__, fmt::format("seed {}", seed)};
};

TEST_P(DriverTest, RendersBandAfterBand) {
  Case frame(seed);
  Pretender executor = frame.executor(frame.some_rows());
  const Result result = frame.render(executor);
  expect_picture(result, frame.request.frame);
  EXPECT_EQ(result.n_tiles, frame.request.frame.n_tiles);
  EXPECT_EQ(result.n_bands, executor.bands().size());
  ASSERT_EQ(executor.lists.size(), executor.bands().size());
  std::vector<double> told;
  double done = 0;
  const double all = frame.request.frame.n_tiles;
  for (std::size_t i = 0; i < executor.lists.size(); ++i) {
    const List& list = executor.lists[i];
    const wavefront::Band& band = executor.bands()[i];
    EXPECT_EQ(list.entries,
              wavefront::tile_curve(frame.request.frame.n_tiles_x, band.first_row, band.n_rows));
    EXPECT_EQ(list.first_place, band.first_pixel);
    EXPECT_EQ(list.n_places, band.n_pixels);
    EXPECT_EQ(list.seconds, kForever);
    const auto n = static_cast<double>(list.entries.size());
    told.push_back(done / all);
    told.push_back((done + n / 2) / all);
    done += n;
  }
  told.push_back(1);
  EXPECT_EQ(frame.told, told);
}

// Each interval leaves some, and most runs end before their time.
TEST_P(DriverTest, GoesOnFromACheckpoint) {
  const test::Folder folder;
  const LedgerOptions options{.folder = folder.path(), .resume = true, .every_seconds = 3};
  Case frame(seed);
  std::size_t n_rendered = 0, n_runs = 0;
  for (std::optional<Result> result; !result; ++n_runs) {
    Pretender executor = frame.executor(frame.some_rows());
    if (n_runs < 5) executor.interrupt_at = frame.random.pick(0, 3);
    result = frame.render(executor, options);
    for (const List& list : executor.lists) EXPECT_EQ(list.seconds, 3);
    const double before = static_cast<double>(n_rendered) / frame.request.frame.n_tiles;
    EXPECT_EQ(frame.told.empty() ? before : frame.told.front(), before);
    EXPECT_TRUE(std::ranges::is_sorted(frame.told)) << testing::PrintToString(frame.told);
    n_rendered += executor.n_rendered;
    if (result) expect_picture(*result, frame.request.frame);
  }
  EXPECT_EQ(n_rendered, frame.request.frame.n_tiles);
  EXPECT_EQ(frame.told.back(), 1);
}

TEST_P(DriverTest, ProcessesShareACheckpoint) {
  const test::Folder folder;
  std::vector<std::jthread> threads;
  for (std::uint64_t process = 0; process < 3; ++process)
    threads.emplace_back([&folder, seed = seed] {
      Case frame(seed);
      Pretender executor = frame.executor(frame.some_rows());
      const auto result = frame.render(executor, {.folder = folder.path(), .share = true});
      expect_picture(*result, frame.request.frame);
    });
}

TEST_P(DriverTest, AdaptiveSamplingGoesOnToHalfOfWhatIsLeft) {
  Case frame(seed, 0.02);
  Pretender executor = frame.executor(1000);
  const Result result = frame.render(executor);
  ASSERT_TRUE(result.samples);
  expect_picture(result, frame.request.frame, result.samples->counts);
  ASSERT_EQ(executor.lists.size(), static_cast<std::size_t>(result.samples->rounds));
  std::vector<double> told;
  double from = 0;
  for (std::size_t i = 0; i < executor.lists.size(); ++i) {
    const double half = (1 + from) / 2;
    told.push_back(from);
    told.push_back((from + half) / 2);
    from = half;
  }
  told.push_back(1);
  EXPECT_EQ(frame.told, told);
}

// Bands, films with places for few samples, a checkpoint: the light of each sample is the same.
TEST_P(DriverTest, AdaptiveSamplingIsTheSameHoweverItIsCut) {
  Case frame(seed, 0.02);
  Pretender whole = frame.executor(1000);
  const Result reference = frame.render(whole);
  const std::size_t few = KDRAY_SAMPLE_RUN * frame.random.pick(1, 4);
  Pretender cut = frame.executor(1, few);
  EXPECT_EQ(frame.render(cut).rgb, reference.rgb);
  EXPECT_TRUE(std::ranges::is_sorted(frame.told)) << testing::PrintToString(frame.told);

  const test::Folder folder;
  const LedgerOptions options{.folder = folder.path(), .resume = true};
  std::size_t n_rendered = 0;
  std::optional<Result> result;
  for (std::size_t n_runs = 0; !result; ++n_runs) {
    Pretender executor = frame.executor(frame.some_rows(), few);
    if (n_runs < 8) executor.interrupt_at = frame.random.pick(0, 9);
    result = frame.render(executor, options);
    EXPECT_TRUE(std::ranges::is_sorted(frame.told)) << testing::PrintToString(frame.told);
    n_rendered += executor.n_rendered;
  }
  EXPECT_EQ(result->rgb, reference.rgb);
  EXPECT_EQ(result->samples->counts, reference.samples->counts);
  EXPECT_EQ(n_rendered, whole.n_rendered);  // each entry once
}

INSTANTIATE_TEST_SUITE_P(Seeds, DriverTest, testing::Range(1, 16));

TEST(Driver, OtherRanksFollow) {
  Case frame(1);
  Pretender executor = frame.executor(1);
  executor.follows = true;
  const Result result = frame.render(executor);
  EXPECT_EQ(executor.n_followed, 1);
  EXPECT_TRUE(executor.lists.empty());
  EXPECT_TRUE(result.rgb.empty());
  EXPECT_TRUE(frame.told.empty());
  EXPECT_EQ(result.n_bands, executor.bands().size());
}

TEST(Driver, ProgressThatThrowsEndsTheFrame) {
  Case frame(2);
  frame.request.progress = [](double) { throw std::runtime_error("enough"); };
  Pretender executor = frame.executor(1);
  EXPECT_THROW(frame.render(executor), std::runtime_error);
}

}  // namespace
}  // namespace kdray::frame
