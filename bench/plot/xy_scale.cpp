#include "bench/plot/xy_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/plot/svg.h"

namespace kdray::bench {

Scale::Scale(bool logarithmic, const std::vector<double>& values, double from_pixel, double to_pixel)
    : log_(logarithmic),
      from_(from_pixel),
      to_(to_pixel),
      lo_(std::numeric_limits<double>::infinity()),
      hi_(-lo_) {
  for (const double v : values)
    if (shows(v)) lo_ = std::min(lo_, at(v)), hi_ = std::max(hi_, at(v));
  if (lo_ > hi_) lo_ = 0, hi_ = 1;
  if (log_) {
    lo_ = std::floor(lo_ * 3) / 3, hi_ = std::ceil(hi_ * 3) / 3;  // about 1, 2, 5, 10
  } else {
    lo_ = std::min(lo_, 0.0), hi_ += 0.05 * (hi_ - lo_);
  }
  if (hi_ == lo_) hi_ = lo_ + 1;
}

double Scale::at(double v) const {
  return log_ ? std::log10(v) : v;
}

bool Scale::shows(double v) const {
  return std::isfinite(v) && (!log_ || v > 0);
}

std::vector<double> Scale::ticks() const {
  std::vector<double> found;
  if (log_) {
    for (int power = static_cast<int>(std::floor(lo_)); power <= hi_; ++power)
      for (const double factor : {1.0, 2.0, 5.0})
        if (const double v = factor * std::pow(10, power); at(v) >= lo_ - 1e-9 && at(v) <= hi_ + 1e-9)
          found.push_back(v);
  } else {
    const double step = svg::step_for(hi_ - lo_);
    for (double v = std::ceil(lo_ / step) * step; v <= hi_ * (1 + 1e-9); v += step) found.push_back(v);
  }
  return found;
}

}  // namespace kdray::bench
