#include "bench/modes/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/error.h"
#include "bench/measure/short_name.h"
#include "bench/plot/svg.h"

namespace kdray::bench {

namespace {

constexpr double kWidth = 900, kLeft = 190, kRight = 70, kTop = 62, kRow = 9, kSchemeGap = 8, kPanelGap = 58;
constexpr double kPixelLeast = 0.4;  // narrower spans would not be seen

constexpr const char* kLaunch = "#1f5f91";
constexpr const char* kTurn = "#e0703f";

// PDPRT's spans are launches; ODPRT's are turns with a part: what arrived, a launch, and what leaves.
const char* color_of(const TimelineSpan& span) {
  return span.name == "launch" ? kLaunch : kTurn;
}

double end_of(std::span<const TimelineSpan> spans) {
  double end = 0;
  for (const TimelineSpan& span : spans) end = std::max(end, span.end);
  return end;
}

class TimelineDrawing {
 public:
  std::string finish(const ModesOptions& options) {
    const std::string title = svg::text(
        20, 24, 16, "start", "What each queue did, scheme by scheme; white is idle", " font-weight=\"bold\"");
    const std::string subtitle = svg::text(
        20, 42, 11, "start",
        fmt::format("{}x{}, depth {}; one frame each", options.width, options.height, options.depth));
    return svg::document(kWidth, y_, title + subtitle + legend() + body_);
  }

  void add(const ModesRun& run) {
    std::vector<std::pair<const ModesRow*, std::vector<TimelineSpan>>> frames;
    double end = 0;
    for (const ModesRow& row : run.rows) {
      if (row.timeline.empty()) continue;
      frames.emplace_back(&row, spans_of(row.timeline));
      end = std::max(end, end_of(frames.back().second));
    }
    if (frames.empty() || !(end > 0)) return;
    body_ += svg::text(20, y_ + 12, 13, "start",
                       fmt::format("{}, {} queues", short_name(run.scene), frames.front().first->queues),
                       " font-weight=\"bold\"");
    y_ += 22;
    const double top = y_;
    for (const auto& [row, spans] : frames) add(*row, spans, end);
    add_axis(top, end);
    y_ += kPanelGap;
  }

  bool empty() const { return body_.empty(); }

 private:
  static double x_of(double seconds, double end) { return kLeft + (kWidth - kLeft - kRight) * seconds / end; }

  void add(const ModesRow& row, std::span<const TimelineSpan> spans, double end) {
    body_ += svg::text(kLeft - 8, y_ + row.queues * kRow / 2 + 4, 11, "end", row.scheme);
    for (const TimelineSpan& span : spans) {
      const double x = x_of(span.start, end);
      body_ += svg::rectangle(x, y_ + span.queue * kRow, std::max(kPixelLeast, x_of(span.end, end) - x),
                              kRow - 2, color_of(span));
    }
    const double own_end = end_of(spans);
    body_ += svg::text(x_of(own_end, end) + 5, y_ + row.queues * kRow / 2 + 4, 10, "start",
                       fmt::format("{:.0f} ms", 1e3 * own_end));
    y_ += row.queues * kRow + kSchemeGap;
  }

  void add_axis(double top, double end) {
    const double step = svg::step_for(1e3 * end);
    for (double ms = 0; ms <= 1e3 * end; ms += step) {
      const double x = x_of(1e-3 * ms, end);
      body_ += svg::line(x, top, x, y_, "#e4e4e4");
      body_ += svg::text(x, y_ + 13, 10, "middle", fmt::format("{:g}", ms));
    }
    body_ += svg::text(kWidth - kRight, y_ + 27, 11, "end", "ms since the frame's first launch");
  }

  static std::string legend() {
    return svg::rectangle(560, 34, 10, 10, kLaunch) + svg::text(574, 43, 11, "start", "PDPRT: a launch") +
           svg::rectangle(700, 34, 10, 10, kTurn) +
           svg::text(714, 43, 11, "start", "ODPRT: a turn with a part");
  }

  std::string body_;
  double y_ = kTop;
};

}  // namespace

std::vector<TimelineSpan> spans_of(const std::string& chrome_trace) {
  std::vector<TimelineSpan> spans;
  try {
    const nlohmann::json trace = nlohmann::json::parse(chrome_trace);
    for (const auto& event : trace.at("traceEvents")) {
      if (event.at("ph") != "X") continue;
      const double start = event.at("ts").get<double>() * 1e-6;
      spans.push_back(
          {event.at("tid"), event.at("name"), start, start + event.at("dur").get<double>() * 1e-6});
    }
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::internal, fmt::format("no timeline: {}", e.what()));
  }
  double first = spans.empty() ? 0 : spans.front().start;
  for (const TimelineSpan& span : spans) first = std::min(first, span.start);
  for (TimelineSpan& span : spans) span.start -= first, span.end -= first;
  std::sort(spans.begin(), spans.end(), [](const TimelineSpan& a, const TimelineSpan& b) {
    return std::tie(a.queue, a.start) < std::tie(b.queue, b.start);
  });
  return spans;
}

std::string timeline_svg(std::span<const ModesRun> runs, const ModesOptions& options) {
  TimelineDrawing drawing;
  for (const ModesRun& run : runs) drawing.add(run);
  return drawing.empty() ? std::string() : drawing.finish(options);
}

}  // namespace kdray::bench
