// What    Plots of points and lines as SVG: panels below each other, each with two axes, linear from 0 or
//         logarithmic.
// Shape   A series has one colour in all panels; its points are joined by lines where the series says so, and
//         have labels where they carry them. What is not finite, or not positive on a logarithmic axis, is
//         left out.
#pragma once

#include <string>
#include <vector>

#include "bench/plot/plot.h"

namespace kdray::bench {

struct Point {
  double x = 0, y = 0;
  std::string label = {};
};

struct Axis {
  std::string unit;
  bool logarithmic = false;
};

struct XyPanel {
  std::string title;
  Axis x, y;
  std::vector<std::vector<Point>> points;  // [series]
};

struct XyPlot {
  std::string title, subtitle;
  std::vector<Series> series;
  bool joined = true;
  std::vector<XyPanel> panels;
};

std::string to_svg(const XyPlot& plot);

}  // namespace kdray::bench
