// What    An axis of a plot: from values to pixels, linear from 0 or logarithmic.
// Shape   It spans the values that it shows and a little more: on a logarithmic axis up to the next of about
//         1, 2, 5, 10.
#pragma once

#include <vector>

namespace kdray::bench {

class Scale {
 public:
  Scale(bool logarithmic, const std::vector<double>& values, double from_pixel, double to_pixel);

  bool shows(double v) const;  // finite, and positive on a logarithmic axis
  double pixel(double v) const { return from_ + (at(v) - lo_) / (hi_ - lo_) * (to_ - from_); }
  std::vector<double> ticks() const;

 private:
  double at(double v) const;

  bool log_;
  double from_, to_;
  double lo_, hi_;
};

}  // namespace kdray::bench
