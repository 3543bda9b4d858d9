// What    Timelines as bench modes draws them: spans in order, from the frame's first on; rows without one
//         are left out.
#include "bench/modes/timeline.h"

#include <gtest/gtest.h>

#include "kdray/error.h"

namespace kdray::bench {
namespace {

constexpr const char* kTrace =
    R"({"traceEvents":[{"name":"thread_name","ph":"M","pid":0,"tid":0,"args":{"name":"queue 0"}},
        {"name":"launch","ph":"X","pid":0,"tid":1,"ts":5000,"dur":3000,"args":{}},
        {"name":"part 2","ph":"X","pid":0,"tid":0,"ts":9000,"dur":1000,"args":{}},
        {"name":"launch","ph":"X","pid":0,"tid":0,"ts":6000,"dur":500,"args":{}}]})";

TEST(ModesTimeline, SpansAreInOrderAndFromTheFirstOn) {
  const std::vector<TimelineSpan> spans = spans_of(kTrace);
  ASSERT_EQ(spans.size(), 3u);
  EXPECT_EQ(spans[0].queue, 0);
  EXPECT_NEAR(spans[0].start, 1e-3, 1e-12);
  EXPECT_NEAR(spans[0].end, 1.5e-3, 1e-12);
  EXPECT_EQ(spans[1].name, "part 2");
  EXPECT_EQ(spans[2].queue, 1);
  EXPECT_NEAR(spans[2].start, 0, 1e-12);
}

TEST(ModesTimeline, WhatIsNoTimelineIsRefused) {
  EXPECT_THROW(spans_of("{"), Error);
  EXPECT_THROW(spans_of(R"({"traceEvents":[{"ph":"X"}]})"), Error);
  EXPECT_TRUE(spans_of(R"({"traceEvents":[]})").empty());
}

TEST(ModesTimeline, EachRowWithATimelineIsDrawn) {
  ModesRun run;
  run.scene = "lopsided.nff";
  run.rows = {{"pdprt contiguous", 2, 2, ""}, {"pdprt bag", 2, 2, ""}, {"odprt sah", 2, 2, "failed"}};
  EXPECT_EQ(timeline_svg(std::vector{run}, {}), "");
  run.rows[0].timeline = run.rows[1].timeline = kTrace;
  const std::string svg = timeline_svg(std::vector{run}, {});
  EXPECT_NE(svg.find("pdprt contiguous"), std::string::npos);
  EXPECT_NE(svg.find("pdprt bag"), std::string::npos);
  EXPECT_EQ(svg.find("odprt sah"), std::string::npos);
  EXPECT_NE(svg.find("lopsided"), std::string::npos);
}

}  // namespace
}  // namespace kdray::bench
