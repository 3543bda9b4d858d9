// What    Plots are well-formed XML whatever they hold, and every bar and label is in them.
#include "bench/plot/plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>
#include <string_view>

#include "bench/plot/label_layout.h"
#include "bench/plot/scatter_plot.h"
#include "bench/plot/xy_plot.h"

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

ScatterPlot crowded_plot() {
  ScatterPlot plot{"A & B",
                   "<sub>",
                   "ms",
                   "RMSE",
                   {{"one", "#111111"}, {"two", "#abcdef", 1}},
                   {{"first", "#333333"}, {"second", "#444444"}},
                   {}};
  ScatterPanel panel{"panel", {{}, {}}, 0.01, "floor"};
  for (int i = 1; i <= 40; ++i)
    panel.points[static_cast<std::size_t>(i % 2)].push_back(
        {1 + 0.01 * i, 1 + 0.02 * (i % 7), "label " + std::to_string(i), i<4, i> 30});
  plot.panels.push_back(panel);
  return plot;
}

TEST(ScatterPlot, IsWellFormedWhateverItHolds) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::nan("");
  EXPECT_EQ(fault_in(to_svg(crowded_plot())), "");
  EXPECT_EQ(fault_in(to_svg(ScatterPlot{})), "");
  ScatterPlot plot = crowded_plot();
  plot.panels = {
      {"nothing to show", {{{0, 1, "a"}, {1, 0, "b"}, {kNan, 1, "c"}, {1, kInfinity, "d"}}}, 0, ""},
      {"one point", {{{5, 5, "alone", true}}}, 0, ""},
      {"none at all", {}, 0, ""}};
  const std::string svg = to_svg(plot);
  EXPECT_EQ(fault_in(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(ScatterPlot, ShowsEveryPointAndTheLabelsThatMatter) {
  const std::string svg = to_svg(crowded_plot());
  EXPECT_EQ(count(svg, "fill=\"#111111\"") + count(svg, "fill=\"#abcdef\""), 2u + 40);
  EXPECT_EQ(count(svg, "font-weight=\"bold\">label"), 3u);  // those on a front
  EXPECT_GT(count(svg, "stroke=\"#333333\""), 2u);
}

TEST(LabelLayout, PlacesLabelsApartAndBesideThePoints) {
  const Box bounds{0, 0, 400, 300};
  LabelLayout layout(bounds);
  std::vector<Box> taken;
  for (int i = 0; i < 20; ++i) {
    const double x = 180 + 3 * i, y = 150 + 7 * (i % 3);
    layout.add_point(x, y, 4);
    taken.push_back({x - 4, y - 4, x + 4, y + 4});
  }
  std::size_t n_placed = 0;
  for (int i = 0; i < 20; ++i) {
    const auto place = layout.place(180 + 3 * i, 150 + 7 * (i % 3), 50, 12, 120);
    if (!place) continue;
    ++n_placed;
    const Box& b = place->box;
    for (const Box& other : taken) EXPECT_FALSE(overlap(b, other)) << i;
    EXPECT_TRUE(b.x0 >= bounds.x0 && b.x1 <= bounds.x1 && b.y0 >= bounds.y0 && b.y1 <= bounds.y1) << i;
    taken.push_back(b);
  }
  EXPECT_GE(n_placed, 10u);
}

TEST(LabelLayout, HasNoPlaceWhereThereIsNoRoom) {
  LabelLayout layout({0, 0, 30, 30});
  EXPECT_FALSE(layout.place(15, 15, 50, 12, 120));
  EXPECT_FALSE(layout.place(15, 15, 10, 10, 5));
  const auto place = LabelLayout({0, 0, 100, 30}).place(15, 15, 50, 12, 120);
  ASSERT_TRUE(place);
  EXPECT_FALSE(place->far);
  EXPECT_GT(place->box.x0, 15);  // to the right where nothing is in the way
}

}  // namespace
}  // namespace kdray::bench
