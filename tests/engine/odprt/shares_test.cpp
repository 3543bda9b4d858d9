// What    Which queue makes which eye rays: every entry is made once, whoever takes it; queues take their own
//         first; tiles go to the owner of what their rays enter first.
#include "engine/odprt/shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <thread>

namespace kdray::test {
namespace {

using odprt::Shares;

std::vector<layout::u32> numbers(std::size_t n) {
  std::vector<layout::u32> list(n);
  std::iota(list.begin(), list.end(), 0u);
  return list;
}

TEST(Shares, OwnFirstThenAnyonesThenTheLongestOther) {
  Shares shares({{{1, 2}, {3, 4, 5}, {6}}, {7, 8}});
  EXPECT_EQ(shares.left(), 8u);
  EXPECT_EQ(shares.take(0, 1), (Shares::Entries{1}));
  EXPECT_EQ(shares.take(0, 2), (Shares::Entries{2, 7}));
  EXPECT_EQ(shares.take(2, 3), (Shares::Entries{6, 8, 3}));
  EXPECT_EQ(shares.take(2, 9), (Shares::Entries{4, 5}));
  EXPECT_TRUE(shares.take(1, 1).empty());
  EXPECT_EQ(shares.left(), 0u);
}

TEST(Shares, EveryEntryIsTakenOnce) {
  for (const std::size_t n : {0u, 1u, 2u, 5u, 64u, 1000u})
    for (const std::size_t n_queues : {1u, 3u, 8u}) {
      const std::vector<layout::u32> list = numbers(n);
      Shares shares(odprt::share_evenly(list, n_queues));
      std::vector<Shares::Entries> taken(n_queues);
      {
        std::vector<std::jthread> threads;
        for (std::size_t q = 0; q < n_queues; ++q)
          threads.emplace_back([&, q] {
            for (Shares::Entries some = shares.take(q, q + 1); !some.empty(); some = shares.take(q, q + 1))
              taken[q].insert(taken[q].end(), some.begin(), some.end());
          });
      }
      std::vector<layout::u32> all;
      for (const Shares::Entries& of_queue : taken) all.insert(all.end(), of_queue.begin(), of_queue.end());
      std::sort(all.begin(), all.end());
      EXPECT_EQ(all, list) << n << " entries, " << n_queues << " queues";
    }
}

// Neighbours in the list are far apart in what is taken, wherever one looks.
TEST(Shares, EntriesGoAllOverTheList) {
  Shares shares(odprt::share_evenly(numbers(1000), 2));
  for (int i = 0; i < 20; ++i) {
    const Shares::Entries some = shares.take(0, 50);
    const auto early = std::count_if(some.begin(), some.end(), [](layout::u32 e) { return e < 500; });
    EXPECT_GT(early, 15);
    EXPECT_LT(early, 35);
  }
}

// From (0, 0, 10) down the z axis: 8 by 4 tiles of 16 pixels, x from -4 to 4 and y from 2 to -2 at z = 0.
layout::Frame frame_from_above() {
  layout::Frame frame{};
  frame.eye[2] = 10;
  frame.forward[2] = -1;
  frame.right[0] = 1;
  frame.up[1] = 1;
  frame.x_scale = 0.8f / 128, frame.x_offset = -0.4f;
  frame.y_scale = -0.4f / 64, frame.y_offset = 0.2f;
  frame.width = 128, frame.height = 64;
  frame.tile_width = frame.tile_height = 16;
  frame.n_tiles_x = 8, frame.n_tiles = 32;
  return frame;
}

// Part 0 on the left, part 1 on the right; behind it all part 2, but for the lowest row of tiles, which sees
// nothing. Parts 0 and 2 are queue 0's.
TEST(Shares, TilesGoToTheOwnerOfWhatTheySeeFirst) {
  const std::vector<layout::PartCell> directory = {
      {{-4, -1, 0}, 0, {-2, 2, 1}, 0},    {{2, -1, 0}, 1, {4, 2, 1}, 6},  // the bounds of the next six
      {{2, -1, 0}, 1, {4, 0.5f, 1}, 2},   {{2, -1, 0}, 1, {3, 0.5f, 1}, 0}, {{3, -1, 0}, 1, {4, 0.5f, 1}, 0},
      {{2, 0.5f, 0}, 1, {4, 2, 1}, 2},    {{2, 0.5f, 0}, 1, {4, 1, 1}, 0},  {{2, 1, 0}, 1, {4, 2, 1}, 0},
      {{-5, -1.1f, -3}, 2, {5, 3, -2}, 0}};
  const std::vector<std::size_t> owner = {0, 1, 0};
  std::vector<layout::u32> tiles;
  for (layout::u32 row = 0; row < 4; ++row)
    for (layout::u32 column = 0; column < 8; ++column) tiles.push_back(KDRAY_TILE(column, row));
  const auto taken_by = [&](std::size_t queue, std::size_t n) {
    Shares shares(odprt::share_by_part(tiles, 2, frame_from_above(), directory, owner));
    Shares::Entries taken = shares.take(queue, n);
    std::sort(taken.begin(), taken.end());
    return taken;
  };
  Shares::Entries of_left, of_right;
  for (const layout::u32 tile : tiles)
    if (KDRAY_TILE_ROW(tile) < 3) (KDRAY_TILE_COLUMN(tile) < 6 ? of_left : of_right).push_back(tile);
  std::sort(of_left.begin(), of_left.end());
  std::sort(of_right.begin(), of_right.end());
  EXPECT_EQ(taken_by(0, of_left.size()), of_left);
  EXPECT_EQ(taken_by(1, of_right.size()), of_right);
  for (const layout::u32 tile : taken_by(1, of_right.size() + 8))
    EXPECT_TRUE(KDRAY_TILE_ROW(tile) == 3 || KDRAY_TILE_COLUMN(tile) >= 6) << "not anyone's";
}

// An eye in a cell is in the part; a camera that sees nothing leaves all to anyone.
TEST(Shares, FromWithinAndFromOutside) {
  layout::Frame frame = frame_from_above();
  const std::vector<layout::u32> tiles = {KDRAY_TILE(0, 0), KDRAY_TILE(7, 3)};
  const std::vector<layout::PartCell> around = {{{-1, -1, 9}, 1, {1, 1, 11}, 0}};
  const std::vector<std::size_t> owner = {0, 1};
  EXPECT_EQ(Shares(odprt::share_by_part(tiles, 2, frame, around, owner)).take(1, 2).size(), 2u);
  frame.forward[2] = 1;
  frame.eye[2] = 12;
  Shares outside(odprt::share_by_part(tiles, 2, frame, around, owner));
  EXPECT_EQ(outside.take(0, 2).size(), 2u);
  EXPECT_EQ(Shares(odprt::share_by_part(tiles, 2, frame, {}, owner)).take(0, 2).size(), 2u);
}

}  // namespace
}  // namespace kdray::test
