#include "bench/plot/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/plot/svg.h"

namespace kdray::bench {

namespace {

using svg::kTextWidth;
using svg::line;
using svg::rectangle;
using svg::step_for;
using svg::text;

constexpr double kBar = 24, kGap = 22;  // a bar with its value fits, and the space between two groups
constexpr double kLeft = 64, kRight = 24;
constexpr double kHead = 62, kLegendLine = 20;
constexpr double kPanel = 300, kTitle = 34, kFoot = 36;  // a panel's height, its title's and its labels'

// Three digits: 0.57, 8.61, 34.5, 120.
std::string short_number(double value) {
  return fmt::format("{:.{}f}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0);
}

double highest(const Panel& panel) {
  double top = 0;
  for (const auto& group : panel.bars)
    for (const auto& bar : group)
      if (bar && std::isfinite(bar->max)) top = std::max(top, bar->max);
  return top > 0 ? top : 1;
}

class Drawing {
 public:
  explicit Drawing(const Plot& plot) : plot_(plot) {
    std::size_t groups = 1;
    for (const Panel& p : plot.panels) groups = std::max(groups, p.groups.size());
    const double wanted = kLeft + static_cast<double>(groups) * group_width() + kRight;
    const double longest = std::max(15 * kTextWidth * static_cast<double>(plot.title.size()),
                                    11 * kTextWidth * static_cast<double>(plot.subtitle.size()));
    width_ = std::max({wanted, kLeft + longest + kRight, 520.0});
  }

  std::string draw() {
    const std::string legend = draw_legend();  // says how many lines it takes
    std::string body = text(kLeft, 24, 15, "start", plot_.title, " font-weight=\"bold\"") +
                       text(kLeft, 42, 11, "start", plot_.subtitle, " fill=\"#555\"") + legend;
    double top = head_;
    for (const Panel& p : plot_.panels) {
      body += draw_panel(p, top);
      top += kPanel;
    }
    return svg::document(width_, top + 8, body);
  }

 private:
  double group_width() const { return kBar * static_cast<double>(plot_.series.size()) + kGap; }

  std::string draw_legend() {
    std::string out;
    double x = kLeft, y = kHead + 10;
    for (const Series& s : plot_.series) {
      const double needed = 20 + 11 * kTextWidth * static_cast<double>(s.name.size()) + 18;
      if (x > kLeft && x + needed > width_ - kRight) x = kLeft, y += kLegendLine;
      out += rectangle(x, y - 10, 12, 12, s.color) + text(x + 18, y, 11, "start", s.name);
      x += needed;
    }
    head_ = y + kLegendLine;
    return out;
  }

  std::string draw_panel(const Panel& panel, double top) {
    const double high = highest(panel), step = step_for(high);
    base_ = top + kPanel - kFoot;
    // Room above the highest whisker for its value.
    scale_ = (kPanel - kFoot - kTitle - 16) / high;
    std::string out = text(kLeft, top + 18, 13, "start", panel.title, " font-weight=\"bold\"");
    for (double v = 0; v <= high * 1.0001; v += step) {
      const double y = base_ - v * scale_;
      out += line(kLeft, y, width_ - kRight, y, v == 0 ? "#333333" : "#dddddd") +
             text(kLeft - 6, y + 4, 11, "end", fmt::format("{:g}", v));
    }
    const double middle = base_ - high * scale_ / 2;
    out += text(16, middle, 11, "middle", plot_.unit,
                fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle));
    for (std::size_t g = 0; g < panel.groups.size(); ++g) out += draw_group(panel, g);
    return out;
  }

  std::string draw_group(const Panel& panel, std::size_t g) {
    const double left = kLeft + static_cast<double>(g) * group_width() + kGap / 2;
    std::string out = text(left + (group_width() - kGap) / 2, base_ + 18, 12, "middle", panel.groups[g]);
    for (std::size_t s = 0; s < plot_.series.size() && s < panel.bars[g].size(); ++s)
      if (const auto& bar = panel.bars[g][s])
        out += draw_bar(*bar, left + kBar * static_cast<double>(s), plot_.series[s].color);
    return out;
  }

  std::string draw_bar(const Spread& bar, double x, const std::string& color) {
    const double y = base_ - bar.median * scale_, center = x + kBar / 2;
    const double y_max = base_ - bar.max * scale_, y_min = base_ - bar.min * scale_;
    return rectangle(x + 1.5, y, kBar - 3, base_ - y, color) + line(center, y_min, center, y_max, "#333333") +
           line(center - 3, y_min, center + 3, y_min, "#333333") +
           line(center - 3, y_max, center + 3, y_max, "#333333") +
           text(center, y_max - 4, 8.5, "middle", short_number(bar.median));
  }

  const Plot& plot_;
  double width_ = 0, head_ = 0;
  double base_ = 0, scale_ = 1;  // of the panel being drawn
};

}  // namespace

std::string to_svg(const Plot& plot) {
  return Drawing(plot).draw();
}

}  // namespace kdray::bench
