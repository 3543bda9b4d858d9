// A frame's checkpoint without a renderer: tiles whose sums follow from their places. Whoever made them,
// however often it was interrupted, in the end each process has all sums.
#include "engine/checkpoint/frame_checkpoint.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "engine/wavefront/tile_order.h"
#include "support/errors.h"
#include "support/folder.h"

namespace kdray::checkpoint {
namespace {

using test::Folder;

constexpr std::uint32_t kWidth = 61, kHeight = 43;

Identity identity() {
  return {hash_of("scene"), hash_of("settings"), hash_of("build"), "--samples 4", "kdray 1"};
}

struct Process {
  Process(const LedgerOptions& options, const Identity& of = identity(),
          const Cut& cut = {kWidth, kHeight, 8, 4}, bool given = false)
      : checkpoint(options, of, cut, given, "device") {}

  // Renders up to `most` tiles; says how many. `sign` -1: as a broken machine does.
  std::size_t render(std::size_t most = 1u << 30, layout::i64 sign = 1) {
    std::size_t n = 0;
    for (auto wanted = begin(); !wanted.empty() && n < most; wanted = checkpoint.next()) {
      wanted.resize(std::min(wanted.size(), std::min(most - n, std::size_t{7})));  // an interval's
      for (const layout::u32 tile : wanted) fill(places(tile), sign);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      checkpoint.keep(wanted);
      n += wanted.size();
    }
    return n;
  }

  // Says what is first.
  std::vector<layout::u32> begin() {
    const Cut& cut = checkpoint.cut();
    const std::uint32_t n_columns = (kWidth + cut.tile_width - 1) / cut.tile_width;
    const std::uint32_t n_rows = (kHeight + cut.tile_height - 1) / cut.tile_height;
    places = [cut](layout::u32 tile) { return places_of(cut, 0, tile); };
    checkpoint.begin({.entries = wavefront::tile_curve(n_columns, 0, n_rows),
                      .places = places,
                      .pitch = kWidth,
                      .sums = sums,
                      .least_chunk = 4});
    return checkpoint.next();
  }

  void fill(const Rectangle& r, layout::i64 sign) {
    for (std::size_t y = r.y; y < r.y + r.height; ++y)
      for (std::size_t i = 3 * (y * kWidth + r.x); i < 3 * (y * kWidth + r.x + r.width); ++i)
        sums[i] = sign * right(i);
  }
  static layout::i64 right(std::size_t i) { return static_cast<layout::i64>(i) * 1000003 - 77; }
  bool is_right() const {
    for (std::size_t i = 0; i < sums.size(); ++i)
      if (sums[i] != right(i)) return false;
    return true;
  }

  FrameCheckpoint checkpoint;
  std::function<Rectangle(layout::u32)> places;
  std::vector<layout::i64> sums = std::vector<layout::i64>(std::size_t{3} * kWidth * kHeight);
};

constexpr std::size_t kTiles = 8 * 11;

TEST(FrameCheckpoint, GoesOnWhereARunWasEnded) {
  const Folder folder;
  LedgerOptions options{.folder = folder / "checkpoint"};
  EXPECT_EQ(Process(options).render(20), 20u);
  EXPECT_TRUE(test::fails([&] { Process again(options); }, "--resume", ErrorCode::usage));
  options.resume = true;
  EXPECT_EQ(Process(options).render(30), 30u);
  Process last(options);
  EXPECT_EQ(last.render(), kTiles - 50);
  EXPECT_TRUE(last.is_right());
  EXPECT_EQ(last.checkpoint.report().found, 50u);
  EXPECT_EQ(last.checkpoint.report().rendered, kTiles - 50);
  EXPECT_EQ(Process(options).render(), 0u);
}

TEST(FrameCheckpoint, RefusesAnother) {
  const Folder folder;
  const LedgerOptions options{.folder = folder.path(), .resume = true};
  Process first(options);
  for (const auto& [change, text] : {std::pair{&Identity::scene, "another scene"},
                                     {&Identity::settings, "other settings"},
                                     {&Identity::build, "another build of kdray"}}) {
    Identity other = identity();
    other.*change = hash_of("another");
    EXPECT_TRUE(test::fails([&] { Process process(options, other); }, text, ErrorCode::input));
  }
  Process other_tiles(options, identity(), {kWidth, kHeight, 16, 16});
  EXPECT_EQ(other_tiles.checkpoint.cut().tile_width, 8u);
  EXPECT_TRUE(test::fails(
      [&] {
        Process process(options, identity(), {kWidth, kHeight, 16, 16}, true);
      },
      "tiles of 8x4", ErrorCode::usage));
}

TEST(FrameCheckpoint, ManyProcessesMakeOnePicture) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Folder folder;
    const LedgerOptions options{.folder = folder.path(), .share = true, .lease_seconds = 0.2};
    std::atomic<std::size_t> n_rendered = 0;
    {
      std::vector<std::jthread> threads;
      for (unsigned t = 0; t < 5; ++t)
        threads.emplace_back([&, t] {
          std::mt19937 random(100 * seed + t);
          std::this_thread::sleep_for(std::chrono::milliseconds(random() % 30));
          if (t < 2) {  // leaves early
            n_rendered += Process(options).render(1 + random() % 20);
            return;
          }
          Process process(options);
          n_rendered += process.render();
          EXPECT_TRUE(process.is_right());
        });
    }
    EXPECT_GE(n_rendered, kTiles);
    EXPECT_EQ(Process(options).render(), 0u);
  }
}

// Its heart beats, but it comes to no end: others do what it has in work as soon as there is nothing else to
// do.
TEST(FrameCheckpoint, NobodyWaitsForLongForAProcessThatHangs) {
  const Folder folder;
  const LedgerOptions options{.folder = folder.path(), .share = true, .lease_seconds = 0.2};
  Process hangs(options), other(options);
  EXPECT_EQ(hangs.render(5), 5u);
  EXPECT_GE(other.render(), kTiles - 5);
  EXPECT_TRUE(other.is_right());
  // It goes on, and finds that all is done, or that what it makes is the same.
  hangs.render();
  EXPECT_TRUE(hangs.is_right());
}

TEST(FrameCheckpoint, WhatSuchAProcessMakesAfterAllIsCompared) {
  const Folder folder;
  const LedgerOptions options{.folder = folder.path(), .share = true, .lease_seconds = 0.2};
  Process broken(options), other(options);
  std::vector<layout::u32> in_work = broken.begin();
  ASSERT_FALSE(in_work.empty());
  other.render();
  EXPECT_TRUE(other.is_right());
  for (const layout::u32 tile : in_work) broken.fill(broken.places(tile), -1);
  EXPECT_TRUE(test::fails([&] { broken.checkpoint.keep(in_work); }, "differ", ErrorCode::input));
}

TEST(FrameCheckpoint, AMachineThatComputesWronglyIsToldOf) {
  const Folder folder;
  const LedgerOptions options{.folder = folder / "here", .resume = true}, apart{.folder = folder / "apart"};
  Process good(options), late(options), broken(apart);
  good.render(5);
  broken.render(5, -1);
  for (const auto& entry : std::filesystem::directory_iterator(apart.folder))
    if (entry.path().extension() == ".tiles")
      std::filesystem::copy_file(entry.path(), options.folder / entry.path().filename());
  EXPECT_TRUE(test::fails([&] { late.render(); }, "was made twice, and the results differ: by device on ",
                          ErrorCode::input));
}

TEST(FrameCheckpoint, RoundsOfRunsAreKeptToo) {
  const Folder folder;
  const LedgerOptions options{.folder = folder.path(), .resume = true};
  const auto render = [&](std::size_t n_keep, std::vector<layout::i64>& sums) {
    FrameCheckpoint checkpoint(options, identity(), {kWidth, kHeight, 8, 4}, false, "device");
    std::size_t n = 0;
    for (const std::uint32_t number : {1u, 2u, 3u}) {
      checkpoint.begin({.number = number,
                        .entries = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
                        .places = [number](layout::u32 run) { return places_of({}, number, run); },
                        .sums = sums});
      for (auto wanted = checkpoint.next(); !wanted.empty(); wanted = checkpoint.next()) {
        if (n == n_keep) return n;
        wanted.resize(1);
        std::fill_n(sums.begin() + wanted[0] * 3 * KDRAY_SAMPLE_RUN, 3 * KDRAY_SAMPLE_RUN,
                    100 * number + wanted[0]);
        checkpoint.keep(wanted);
        ++n;
      }
    }
    return n;
  };
  std::vector<layout::i64> sums(30 * KDRAY_SAMPLE_RUN), again(30 * KDRAY_SAMPLE_RUN);
  EXPECT_EQ(render(17, sums), 17u);
  EXPECT_EQ(render(100, again), 13u);
  for (std::size_t i = 0; i < again.size(); ++i)
    ASSERT_EQ(again[i], static_cast<layout::i64>(300 + i / (3 * KDRAY_SAMPLE_RUN)));
}

TEST(FrameCheckpoint, AFolderThatCannotBeMade) {
  const Folder folder;
  folder.put("file", "");
  EXPECT_TRUE(
      test::fails([&] { Process process({.folder = folder / "file"}); }, "can't be made", ErrorCode::input));
}

}  // namespace
}  // namespace kdray::checkpoint
