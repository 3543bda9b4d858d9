// What    Bar plots as SVG: panels below each other, in each groups of bars, one bar for each series.
// Shape   A bar is a median with a whisker from min to max and its value above it; a series without a value
//         in a group has no bar there. Every panel has a scale of its own from 0.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/measure/spread.h"

namespace kdray::bench {

struct Series {
  std::string name, color;  // "#rrggbb"
};

struct Panel {
  std::string title;
  std::vector<std::string> groups;
  std::vector<std::vector<std::optional<Spread>>> bars;  // [group][series]
};

struct Plot {
  std::string title, subtitle, unit;
  std::vector<Series> series;
  std::vector<Panel> panels;
};

std::string to_svg(const Plot& plot);

}  // namespace kdray::bench
