#include "bench/plot/xy_plot.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/plot/svg.h"
#include "bench/plot/xy_scale.h"

namespace kdray::bench {

namespace {

constexpr double kLeft = 72, kRight = 130;  // the right has room for the last point's label
constexpr double kHead = 62, kLegendLine = 20;
constexpr double kPanel = 330, kTitle = 34, kFoot = 56;

std::vector<double> all_of(const XyPanel& panel, double Point::*coordinate) {
  std::vector<double> values;
  for (const auto& points : panel.points)
    for (const Point& p : points) values.push_back(p.*coordinate);
  return values;
}

class Drawing {
 public:
  explicit Drawing(const XyPlot& plot) : plot_(plot) {
    const double longest = std::max(15 * svg::kTextWidth * static_cast<double>(plot.title.size()),
                                    11 * svg::kTextWidth * static_cast<double>(plot.subtitle.size()));
    width_ = std::max(kLeft + longest + 24, 720.0);
  }

  std::string draw() const {
    double top = kHead;
    std::string body = svg::text(kLeft, 24, 15, "start", plot_.title, " font-weight=\"bold\"") +
                       svg::text(kLeft, 42, 11, "start", plot_.subtitle, " fill=\"#555\"") + legend(top);
    for (const XyPanel& p : plot_.panels) {
      body += panel(p, top);
      top += kPanel;
    }
    return svg::document(width_, top + 8, body);
  }

 private:
  // Draws the legend and moves `top` below it.
  std::string legend(double& top) const {
    std::string out;
    double x = kLeft, y = top + 10;
    for (const Series& s : plot_.series) {
      const double needed = 38 + 11 * svg::kTextWidth * static_cast<double>(s.name.size());
      if (x > kLeft && x + needed > width_ - 24) x = kLeft, y += kLegendLine;
      out += svg::circle(x + 6, y - 4, 5, s.color) + svg::text(x + 18, y, 11, "start", s.name);
      x += needed;
    }
    top = y + kLegendLine;
    return out;
  }

  std::string panel(const XyPanel& p, double top) const {
    const double bottom = top + kPanel - kFoot, right = width_ - kRight;
    const Scale x(p.x.logarithmic, all_of(p, &Point::x), kLeft, right);
    const Scale y(p.y.logarithmic, all_of(p, &Point::y), bottom, top + kTitle);
    std::string out = svg::text(kLeft, top + 18, 13, "start", p.title, " font-weight=\"bold\"");
    for (const double v : y.ticks())
      out += svg::line(kLeft, y.pixel(v), right, y.pixel(v), "#dddddd") +
             svg::text(kLeft - 6, y.pixel(v) + 4, 11, "end", fmt::format("{:g}", v));
    for (const double v : x.ticks())
      out += svg::line(x.pixel(v), top + kTitle, x.pixel(v), bottom, "#dddddd") +
             svg::text(x.pixel(v), bottom + 16, 11, "middle", fmt::format("{:g}", v));
    out += svg::line(kLeft, bottom, right, bottom, "#333333") +
           svg::line(kLeft, top + kTitle, kLeft, bottom, "#333333") +
           svg::text((kLeft + right) / 2, bottom + 34, 11, "middle", p.x.unit);
    const double middle = (top + kTitle + bottom) / 2;
    out += svg::text(16, middle, 11, "middle", p.y.unit,
                     fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle));
    for (std::size_t s = 0; s < plot_.series.size() && s < p.points.size(); ++s)
      out += series(p.points[s], x, y, plot_.series[s].color);
    return out;
  }

  std::string series(const std::vector<Point>& points, const Scale& x, const Scale& y,
                     const std::string& color) const {
    std::string out;
    const Point* last = nullptr;
    for (const Point& p : points) {
      if (!x.shows(p.x) || !y.shows(p.y)) continue;
      if (plot_.joined && last != nullptr)
        out += svg::line(x.pixel(last->x), y.pixel(last->y), x.pixel(p.x), y.pixel(p.y), color);
      out += svg::circle(x.pixel(p.x), y.pixel(p.y), 4, color);
      if (!p.label.empty()) out += svg::text(x.pixel(p.x) + 7, y.pixel(p.y) - 4, 10, "start", p.label);
      last = &p;
    }
    return out;
  }

  const XyPlot& plot_;
  double width_ = 0;
};

}  // namespace

std::string to_svg(const XyPlot& plot) {
  return Drawing(plot).draw();
}

}  // namespace kdray::bench
