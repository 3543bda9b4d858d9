// What    Plots of labelled points over two logarithmic axes, with the fronts of those that nothing beats, as
//         SVG.
// Shape   Panels below each other; a series has one colour in all of them. Labels are placed where they cover
//         nothing; those of lesser points are left out where there is no room. What is not finite or not
//         positive is left out.
#pragma once

#include <string>
#include <vector>

#include "bench/plot/plot.h"

namespace kdray::bench {

struct ScatterPoint {
  double x = 0, y = 0;
  std::string label = {};
  bool on_front = false;
  bool lesser = false;  // drawn small, labelled only where there is room
};

struct ScatterPanel {
  std::string title;
  std::vector<std::vector<ScatterPoint>> points;  // [series]
  double floor = 0;                               // a dashed line at this y; 0: none
  std::string floor_label = {};
};

struct ScatterSeries {
  std::string name, color;
  int front = 0;  // the points on a front of the same number, over all series, are joined to a staircase
};

struct ScatterPlot {
  std::string title, subtitle, x_unit, y_unit;
  std::vector<ScatterSeries> series;
  std::vector<std::pair<std::string, std::string>> fronts;  // name and colour, by number
  std::vector<ScatterPanel> panels;
};

std::string to_svg(const ScatterPlot& plot);

}  // namespace kdray::bench
