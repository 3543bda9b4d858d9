// What    Plots are well-formed XML whatever they hold, and every bar and label is in them.
#include "bench/plot.h"

#include <gtest/gtest.h>

#include <limits>
#include <regex>
#include <string_view>

#include "bench/xy_plot.h"

namespace kdray::bench {
namespace {

// Whether tags nest, attributes are quoted, and text holds no bare '<' or '&'. Empty when all is well.
std::string fault_in(std::string_view xml) {
  static const std::regex kTag(
      "<(/?)([a-zA-Z]+)((?: [a-zA-Z0-9-]+=\"[^\"<&]*(?:&[a-z]+;[^\"<&]*)*\")*)(/?)>");
  static const std::regex kText("(?:[^<&]|&(?:amp|lt|gt|quot);)*");
  std::vector<std::string> open;
  std::string rest(xml);
  const std::string head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  if (rest.rfind(head, 0) != 0) return "no declaration";
  rest.erase(0, head.size());
  while (!rest.empty()) {
    const std::size_t next = std::min(rest.find('<'), rest.size());
    if (!std::regex_match(rest.substr(0, next), kText)) return "bad text: " + rest.substr(0, next);
    rest.erase(0, next);
    if (rest.empty()) break;
    std::smatch tag;
    if (!std::regex_search(rest, tag, kTag, std::regex_constants::match_continuous))
      return "bad tag: " + rest.substr(0, 80);
    if (tag[1].length() > 0) {
      if (open.empty() || open.back() != tag[2]) return "closes what is not open: " + tag[2].str();
      open.pop_back();
    } else if (tag[4].length() == 0) {
      open.push_back(tag[2]);
    }
    rest = tag.suffix();
  }
  return open.empty() ? "" : "not closed: " + open.back();
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

Plot small_plot() {
  return {
      "A & B <title> \"quoted\"",
      "sub",
      "Mrays/s",
      {{"one", "#111111"}, {"two", "#222222"}},
      {{"panel", {"x", "y"}, {{Spread{1, 0.5, 2}, Spread{3, 2, 4}}, {std::nullopt, Spread{120, 90, 130}}}}}};
}

TEST(Plot, IsWellFormed) {
  EXPECT_EQ(fault_in(to_svg(small_plot())), "");
  EXPECT_NE(fault_in("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg><text>a & b</text></svg>"), "");
  EXPECT_NE(fault_in("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg><text>a</svg></text>"), "");
}

TEST(Plot, HoldsEveryBarAndLabel) {
  const std::string svg = to_svg(small_plot());
  EXPECT_EQ(count(svg, "fill=\"#111111\""), 2u);  // the legend and one bar
  EXPECT_EQ(count(svg, "fill=\"#222222\""), 3u);
  for (const char* const label : {">x<", ">y<", ">one<", ">two<", ">panel<", ">Mrays/s<", ">1.00<", ">3.00<",
                                  ">120<", "A &amp; B &lt;title&gt; &quot;quoted&quot;"})
    EXPECT_EQ(count(svg, label), 1u) << label;
}

TEST(Plot, OfNothingIsStillAPlot) {
  EXPECT_EQ(fault_in(to_svg(Plot{})), "");
  EXPECT_EQ(fault_in(to_svg({"t", "", "u", {{"s", "#000000"}}, {{"p", {"g"}, {{std::nullopt}}}}})), "");
  EXPECT_EQ(fault_in(to_svg({"t", "", "u", {{"s", "#000000"}}, {{"p", {"g"}, {{Spread{0, 0, 0}}}}}})), "");
}

XyPlot small_xy_plot() {
  const std::vector<Point> linear = {{0, 5, "first"}, {10, 50, ""}};
  const std::vector<Point> beyond = {
      {1, 0, "no logarithm"}, {2, std::numeric_limits<double>::infinity(), ""}, {3, 1e6, ""}};
  return {"A & B",
          "<sub>",
          {{"one", "#111111"}, {"two", "#222222"}},
          true,
          {{"panel", {"x", false}, {"y", true}, {linear, beyond}}}};
}

TEST(XyPlot, IsWellFormed) {
  EXPECT_EQ(fault_in(to_svg(small_xy_plot())), "");
  EXPECT_EQ(fault_in(to_svg(XyPlot{})), "");
  EXPECT_EQ(
      fault_in(to_svg(XyPlot{"t", "", {{"s", "#000000"}}, false, {{"p", {"x", true}, {"y", false}, {{}}}}})),
      "");
  EXPECT_EQ(fault_in(to_svg(XyPlot{
                "t", "", {{"s", "#000000"}}, true, {{"p", {"x", true}, {"y", true}, {{{7, 7, ""}}}}}})),
            "");
}

TEST(XyPlot, ShowsEveryPointThatItsAxesHold) {
  const std::string svg = to_svg(small_xy_plot());
  EXPECT_EQ(count(svg, "fill=\"#111111\""), 3u);    // the legend and two points
  EXPECT_EQ(count(svg, "stroke=\"#111111\""), 1u);  // joined by a line
  EXPECT_EQ(count(svg, "fill=\"#222222\""), 2u);    // 0 and infinity have no logarithm
  EXPECT_EQ(count(svg, ">first<"), 1u);
  EXPECT_EQ(count(svg, ">no logarithm<"), 0u);
  EXPECT_EQ(count(svg, "nan"), 0u);
  XyPlot apart = small_xy_plot();
  apart.joined = false;
  EXPECT_EQ(count(to_svg(apart), "stroke=\"#111111\""), 0u);
}

}  // namespace
}  // namespace kdray::bench
