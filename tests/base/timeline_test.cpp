// What    The timeline of a frame: rows and spans come out in the trace format, whoever adds them.
#include "base/timeline.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

namespace kdray::test {
namespace {

using timeline::Timeline;

TEST(Timeline, SpansBecomeCompleteEvents) {
  Timeline t;
  t.name_row(1, "queue 1");
  t.add(1, "wave", 0.5, 0.75, {{"rays_in", 512}});
  const auto json = nlohmann::json::parse(t.json());
  const auto& events = json.at("traceEvents");
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].at("ph"), "M");
  EXPECT_EQ(events[0].at("args").at("name"), "queue 1");
  EXPECT_EQ(events[1].at("ph"), "X");
  EXPECT_EQ(events[1].at("tid"), 1);
  EXPECT_DOUBLE_EQ(events[1].at("ts"), 5e5);
  EXPECT_DOUBLE_EQ(events[1].at("dur"), 2.5e5);
  EXPECT_DOUBLE_EQ(events[1].at("args").at("rays_in"), 512);
}

TEST(Timeline, RowsAreSortedByTime) {
  Timeline t;
  t.add(0, "later", 2, 3);
  t.add(1, "other", 0, 9);
  t.add(0, "sooner", 1, 2);
  const auto spans = t.spans(0);
  ASSERT_EQ(spans.size(), 2u);
  EXPECT_EQ(spans[0].name, "sooner");
  EXPECT_EQ(spans[1].name, "later");
}

TEST(Timeline, ManyThreadsLoseNothing) {
  Timeline t;
  {
    std::vector<std::jthread> threads;
    for (int row = 0; row < 4; ++row)
      threads.emplace_back([&t, row] {
        for (int i = 0; i < 1000; ++i) t.add(row, "span", i, i + 1);
      });
  }
  for (int row = 0; row < 4; ++row) EXPECT_EQ(t.spans(row).size(), 1000u);
}

}  // namespace
}  // namespace kdray::test
