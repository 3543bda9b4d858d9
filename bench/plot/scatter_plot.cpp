#include "bench/plot/scatter_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/plot/label_layout.h"
#include "bench/plot/svg.h"
#include "bench/plot/xy_scale.h"

namespace kdray::bench {

namespace {

constexpr double kWidth = 1000, kLeft = 76, kRight = 24;
constexpr double kHead = 62, kLegendLine = 20;
constexpr double kPanel = 620, kTitle = 34, kFoot = 58;
constexpr double kLabel = 10, kSize = 5, kLesserSize = 3;
constexpr double kBoldWidth = 0.72;  // of a letter, as svg::kTextWidth
constexpr double kFarthest = 120, kFarthestLesser = 30;

std::string dashed(double x0, double y0, double x1, double y1, const std::string& color) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-dasharray=\"6 "
      "4\"/>\n",
      x0, y0, x1, y1, color);
}

std::vector<double> all_of(const ScatterPanel& panel, double ScatterPoint::*coordinate) {
  std::vector<double> values;
  for (const auto& points : panel.points)
    for (const ScatterPoint& p : points) values.push_back(p.*coordinate);
  return values;
}

struct Corner {
  double x, y;
};

class PanelDrawing {
 public:
  PanelDrawing(const ScatterPlot& plot, const ScatterPanel& panel, double top)
      : plot_(plot),
        panel_(panel),
        top_(top + kTitle),
        bottom_(top + kPanel - kFoot),
        x_(true, all_of(panel, &ScatterPoint::x), kLeft, kWidth - kRight),
        y_(true, heights(panel), bottom_, top_),
        layout_({kLeft + 2, top_ + 2, kWidth - kRight - 2, bottom_ - 2}) {}

  std::string draw() {
    std::string out = svg::text(kLeft, top_ - 16, 13, "start", panel_.title, " font-weight=\"bold\"");
    out += axes() + floor();
    for (std::size_t f = 0; f < plot_.fronts.size(); ++f) out += front(f);
    const std::string points = draw_points();
    return out + labels() + points;
  }

 private:
  static std::vector<double> heights(const ScatterPanel& panel) {
    std::vector<double> values = all_of(panel, &ScatterPoint::y);
    values.push_back(panel.floor);
    return values;
  }

  bool shows(const ScatterPoint& p) const { return x_.shows(p.x) && y_.shows(p.y); }

  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t s = 0; s < plot_.series.size() && s < panel_.points.size(); ++s)
      for (const ScatterPoint& p : panel_.points[s])
        if (shows(p)) visit(plot_.series[s], p);
  }

  std::string axes() const {
    std::string out;
    const double right = kWidth - kRight;
    for (const double v : y_.ticks())
      out += svg::line(kLeft, y_.pixel(v), right, y_.pixel(v), "#e4e4e4") +
             svg::text(kLeft - 6, y_.pixel(v) + 4, 11, "end", fmt::format("{:g}", v));
    for (const double v : x_.ticks())
      out += svg::line(x_.pixel(v), top_, x_.pixel(v), bottom_, "#e4e4e4") +
             svg::text(x_.pixel(v), bottom_ + 16, 11, "middle", fmt::format("{:g}", v));
    const double middle = (top_ + bottom_) / 2;
    return out + svg::line(kLeft, bottom_, right, bottom_, "#333333") +
           svg::line(kLeft, top_, kLeft, bottom_, "#333333") +
           svg::text((kLeft + right) / 2, bottom_ + 36, 11, "middle", plot_.x_unit) +
           svg::text(16, middle, 11, "middle", plot_.y_unit,
                     fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle));
  }

  std::string floor() {
    if (!y_.shows(panel_.floor)) return "";
    const double y = y_.pixel(panel_.floor);
    layout_.add_line(kLeft, y, kWidth - kRight, y);
    const double width = kLabel * svg::kTextWidth * static_cast<double>(panel_.floor_label.size());
    layout_.add_point(kLeft + 4 + width / 2, y - 6, 7);  // its own label's room, about
    return dashed(kLeft, y, kWidth - kRight, y, "#999999") +
           svg::text(kLeft + 6, y - 4, kLabel, "start", panel_.floor_label, " fill=\"#777\"");
  }

  // A staircase: what error can be had in what time. Down at each point, then level to the next.
  std::string front(std::size_t number) {
    std::vector<Corner> corners;
    for_each([&](const ScatterSeries& s, const ScatterPoint& p) {
      if (p.on_front && s.front == static_cast<int>(number))
        corners.push_back({x_.pixel(p.x), y_.pixel(p.y)});
    });
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.x < b.x; });
    std::string out;
    const auto join = [&](double x0, double y0, double x1, double y1) {
      layout_.add_line(x0, y0, x1, y1);
      out += svg::line(x0, y0, x1, y1, plot_.fronts[number].second);
    };
    for (std::size_t i = 1; i < corners.size(); ++i) {
      join(corners[i - 1].x, corners[i - 1].y, corners[i].x, corners[i - 1].y);
      join(corners[i].x, corners[i - 1].y, corners[i].x, corners[i].y);
    }
    return out;
  }

  std::string draw_points() {
    std::string out;
    for_each([&](const ScatterSeries& s, const ScatterPoint& p) {
      const double x = x_.pixel(p.x), y = y_.pixel(p.y), size = p.lesser ? kLesserSize : kSize;
      layout_.add_point(x, y, size);
      if (p.on_front) out += svg::circle(x, y, size + 2, "#222222");
      out += svg::circle(x, y, size, s.color);
    });
    return out;
  }

  // First those on a front, then others, lesser ones last.
  std::string labels() {
    std::vector<const ScatterPoint*> order;
    for_each([&](const ScatterSeries&, const ScatterPoint& p) {
      if (!p.label.empty()) order.push_back(&p);
    });
    const auto rank = [](const ScatterPoint* p) { return p->lesser ? 2 : p->on_front ? 0 : 1; };
    std::stable_sort(order.begin(), order.end(), [&](auto* a, auto* b) { return rank(a) < rank(b); });
    std::string out;
    for (const ScatterPoint* p : order) out += label(*p);
    return out;
  }

  std::string label(const ScatterPoint& p) {
    const double x = x_.pixel(p.x), y = y_.pixel(p.y);
    const double letter = kLabel * (p.on_front ? kBoldWidth : svg::kTextWidth);
    const double width = letter * static_cast<double>(p.label.size());
    const auto place =
        layout_.place(x, y, width, kLabel + 2, p.lesser ? kFarthestLesser : kFarthest, !p.lesser);
    if (!place) return "";
    const Box& b = place->box;
    std::string out = svg::text((b.x0 + b.x1) / 2, b.y1 - 3, kLabel, "middle", p.label,
                                p.on_front ? " font-weight=\"bold\"" : "");
    if (place->far) out += svg::line(x, y, std::clamp(x, b.x0, b.x1), std::clamp(y, b.y0, b.y1), "#aaaaaa");
    return out;
  }

  const ScatterPlot& plot_;
  const ScatterPanel& panel_;
  double top_, bottom_;
  Scale x_, y_;
  LabelLayout layout_;
};

class Legend {
 public:
  std::string entry(const std::string& mark, const std::string& name) {
    const double needed = 38 + 11 * svg::kTextWidth * static_cast<double>(name.size());
    if (x_ > kLeft && x_ + needed > kWidth - kRight) x_ = kLeft, y_ += kLegendLine;
    const std::string out =
        fmt::format("<g transform=\"translate({:.1f} {:.1f})\">{}</g>\n", x_, y_ - 4, mark) +
        svg::text(x_ + 22, y_, 11, "start", name);
    x_ += needed;
    return out;
  }
  double bottom() const { return y_ + kLegendLine; }

 private:
  double x_ = kLeft, y_ = kHead + 10;
};

}  // namespace

std::string to_svg(const ScatterPlot& plot) {
  std::string body = svg::text(kLeft, 24, 15, "start", plot.title, " font-weight=\"bold\"") +
                     svg::text(kLeft, 42, 11, "start", plot.subtitle, " fill=\"#555\"");
  Legend legend;
  for (const ScatterSeries& s : plot.series) body += legend.entry(svg::circle(8, 0, kSize, s.color), s.name);
  for (const auto& [name, color] : plot.fronts)
    body += legend.entry(svg::line(0, 0, 16, 0, color) + svg::circle(8, 0, 4, "#222222"), name);
  double top = legend.bottom();
  for (const ScatterPanel& panel : plot.panels) {
    body += PanelDrawing(plot, panel, top).draw();
    top += kPanel;
  }
  return svg::document(kWidth, top + 8, body);
}

}  // namespace kdray::bench
