#include "io/image/compare.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kdray::image::flip {

// The colour spaces and the distance of FLIP (paper, sections 4.1.1 and 4.1.3).

namespace {

// Linear sRGB to CIE XYZ: the primaries and the D65 white of IEC 61966-2-1, white being (1, 1, 1) in RGB.
// GLM's matrices are written column by column.
const dmat3 kToXyz(0.41239080, 0.21263901, 0.01933082,   // red
                   0.35758434, 0.71516868, 0.11919478,   // green
                   0.18048079, 0.07219232, 0.95053215);  // blue
const dmat3 kFromXyz = glm::inverse(kToXyz);
const dvec3 kWhite = kToXyz * dvec3(1);

double lab_curve(double t) {
  constexpr double kDelta = 6.0 / 29;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
}

}  // namespace

dvec3 ycxcz(const dvec3& linear_rgb) {
  const dvec3 p = kToXyz * linear_rgb / kWhite;
  return {116 * p.y - 16, 500 * (p.x - p.y), 200 * (p.y - p.z)};
}

dvec3 linear_rgb(const dvec3& ycxcz) {
  const double y = (ycxcz.x + 16) / 116;
  return kFromXyz * (dvec3(y + ycxcz.y / 500, y, y - ycxcz.z / 200) * kWhite);
}

dvec3 hunt_lab(const dvec3& linear_rgb) {
  const dvec3 p = kToXyz * linear_rgb / kWhite;
  const dvec3 f(lab_curve(p.x), lab_curve(p.y), lab_curve(p.z));
  const double lightness = 116 * f.y - 16;
  return {lightness, 0.01 * lightness * 500 * (f.x - f.y), 0.01 * lightness * 200 * (f.y - f.z)};
}

double hyab(const dvec3& a, const dvec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

double largest_color_distance() {
  static const double distance = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
  return distance;
}

double redistribute(double distance) {
  constexpr double kKnee = 0.4, kKneeError = 0.95;  // p_c and p_t of the paper
  const double largest = largest_color_distance();
  const double knee = kKnee * largest;
  if (distance < knee) return kKneeError / knee * distance;
  return std::min(1.0, kKneeError + (distance - knee) / (largest - knee) * (1 - kKneeError));
}

}  // namespace kdray::image::flip

namespace kdray::image {

namespace {

using Plane = std::vector<float>;
using Taps = std::vector<float>;  // 2 * radius + 1 weights

struct Size {
  int width, height;
};

// Filters rows: each value becomes the sum over the taps of taps[tap] * row[x + tap]; beyond its ends a row
// goes on with its last value.
Plane filter_rows(const Plane& in, Size size, const Taps& taps) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(in.size());
  std::vector<float> padded(static_cast<std::size_t>(size.width) + 2 * radius);
  for (int y = 0; y < size.height; ++y) {
    const float* row = in.data() + static_cast<std::size_t>(y) * size.width;
    float* sums = out.data() + static_cast<std::size_t>(y) * size.width;
    std::fill_n(padded.begin(), radius, row[0]);
    std::copy_n(row, size.width, padded.begin() + radius);
    std::fill_n(padded.begin() + radius + size.width, radius, row[size.width - 1]);
    for (std::size_t tap = 0; tap < taps.size(); ++tap)
      for (int x = 0; x < size.width; ++x) sums[x] += taps[tap] * padded[x + tap];
  }
  return out;
}

Plane filter_columns(const Plane& in, Size size, const Taps& taps) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(in.size());
  for (int y = 0; y < size.height; ++y) {
    float* sums = out.data() + static_cast<std::size_t>(y) * size.width;
    for (int tap = -radius; tap <= radius; ++tap) {
      const int from = std::clamp(y + tap, 0, size.height - 1);
      const float* row = in.data() + static_cast<std::size_t>(from) * size.width;
      const float weight = taps[static_cast<std::size_t>(tap + radius)];
      for (int x = 0; x < size.width; ++x) sums[x] += weight * row[x];
    }
  }
  return out;
}

Plane filter(const Plane& in, Size size, const Taps& along_x, const Taps& along_y) {
  return filter_columns(filter_rows(in, size, along_x), size, along_y);
}

// ---- the colour pipeline

struct Gaussian {
  Taps taps;   // sum 1
  double sum;  // of the weights before
};

Gaussian gaussian(double b, int radius, double pixels_per_degree) {
  Gaussian g{Taps(2 * static_cast<std::size_t>(radius) + 1), 0};
  const auto weight = [&](int x) {
    const double degrees = x / pixels_per_degree;
    return std::exp(-std::numbers::pi * std::numbers::pi * degrees * degrees / b);
  };
  for (int x = -radius; x <= radius; ++x) g.sum += weight(x);
  for (int x = -radius; x <= radius; ++x)
    g.taps[static_cast<std::size_t>(x + radius)] = static_cast<float>(weight(x) / g.sum);
  return g;
}

// What the eye's contrast sensitivity leaves of the opponent colours at this distance (section 4.1.2).
// Blue-yellow is the sum of two Gaussians a * sqrt(pi / b) * exp(-pi^2 d^2 / b), the others are one.
class ContrastFilter {
 public:
  explicit ContrastFilter(double pixels_per_degree) {
    constexpr double kA1 = 34.1, kB1 = 0.04, kA2 = 13.5, kB2 = 0.025;
    const double pi = std::numbers::pi;
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kB1 / (2 * pi * pi)) * pixels_per_degree));
    achromatic_ = gaussian(0.0047, radius, pixels_per_degree).taps;
    red_green_ = gaussian(0.0053, radius, pixels_per_degree).taps;
    const Gaussian wide = gaussian(kB1, radius, pixels_per_degree);
    const Gaussian narrow = gaussian(kB2, radius, pixels_per_degree);
    const double wide_part = kA1 * std::sqrt(pi / kB1) * wide.sum * wide.sum;
    const double narrow_part = kA2 * std::sqrt(pi / kB2) * narrow.sum * narrow.sum;
    wide_ = wide.taps, narrow_ = narrow.taps;
    wide_share_ = static_cast<float>(wide_part / (wide_part + narrow_part));
  }

  void apply(Plane planes[3], Size size) const {
    planes[0] = filter(planes[0], size, achromatic_, achromatic_);
    planes[1] = filter(planes[1], size, red_green_, red_green_);
    const Plane wide = filter(planes[2], size, wide_, wide_);
    const Plane narrow = filter(planes[2], size, narrow_, narrow_);
    for (std::size_t i = 0; i < wide.size(); ++i)
      planes[2][i] = wide_share_ * wide[i] + (1 - wide_share_) * narrow[i];
  }

 private:
  Taps achromatic_, red_green_, wide_, narrow_;
  float wide_share_;
};

double color_error(const dvec3& a, const dvec3& b) {
  const auto lab = [](const dvec3& ycxcz) {
    return flip::hunt_lab(glm::clamp(flip::linear_rgb(ycxcz), dvec3(0), dvec3(1)));
  };
  return flip::redistribute(std::pow(flip::hyab(lab(a), lab(b)), 0.7));
}

// ---- the feature pipeline

struct FeatureTaps {
  Taps smooth, edge, point;
};

// Positive weights are scaled to the sum 1, negative ones to -1.
Taps balanced(const std::vector<double>& weights) {
  double positive = 0, negative = 0;
  for (double w : weights) (w > 0 ? positive : negative) += std::abs(w);
  Taps taps;
  for (double w : weights) taps.push_back(static_cast<float>(w > 0 ? w / positive : w / negative));
  return taps;
}

// Returns a Gaussian as wide as the smallest feature an eye looks for, and its first and second derivative
// (section 4.2).
FeatureTaps feature_taps(double pixels_per_degree) {
  const double deviation = 0.5 * 0.082 * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  std::vector<double> edge, point;
  FeatureTaps taps;
  double sum = 0;
  for (int x = -radius; x <= radius; ++x) sum += std::exp(-x * x / (2 * deviation * deviation));
  for (int x = -radius; x <= radius; ++x) {
    const double weight = std::exp(-x * x / (2 * deviation * deviation));
    taps.smooth.push_back(static_cast<float>(weight / sum));
    edge.push_back(-x * weight);
    point.push_back((x * x / (deviation * deviation) - 1) * weight);
  }
  taps.edge = balanced(edge), taps.point = balanced(point);
  return taps;
}

struct Features {
  Plane edges, points;  // how strongly each pixel is one
};

Plane magnitude(const Plane& x, const Plane& y) {
  Plane out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) out[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
  return out;
}

Features find_features(const Plane& luminance, Size size, const FeatureTaps& taps) {
  return {magnitude(filter(luminance, size, taps.edge, taps.smooth),
                    filter(luminance, size, taps.smooth, taps.edge)),
          magnitude(filter(luminance, size, taps.point, taps.smooth),
                    filter(luminance, size, taps.smooth, taps.point))};
}

// ---- both

struct Analysis {
  Plane opponent[3];  // filtered
  Features features;
};

Analysis analyse(const Image& image, double pixels_per_degree) {
  Analysis result;
  const Size size{image.width, image.height};
  for (Plane& plane : result.opponent) plane.resize(image.pixels.size());
  Plane luminance(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    dvec3 color;
    for (int c = 0; c < 3; ++c) {
      const double v = image.pixels[i][c];
      color[c] = v > 0 ? std::min(v, 1.0) : 0;  // NaN becomes 0
    }
    const dvec3 opponent = flip::ycxcz(color);
    for (int c = 0; c < 3; ++c) result.opponent[c][i] = static_cast<float>(opponent[c]);
    luminance[i] = static_cast<float>((opponent.x + 16) / 116);
  }
  result.features = find_features(luminance, size, feature_taps(pixels_per_degree));
  ContrastFilter(pixels_per_degree).apply(result.opponent, size);
  return result;
}

double feature_error(const Features& a, const Features& b, std::size_t i) {
  const double difference = std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i]));
  return std::min(1.0, std::sqrt(difference / std::numbers::sqrt2));
}

}  // namespace

std::vector<float> flip_map(const Image& reference, const Image& test, double pixels_per_degree) {
  const Analysis a = analyse(reference, pixels_per_degree), b = analyse(test, pixels_per_degree);
  std::vector<float> errors(reference.pixels.size());
  const auto opponent = [](const Analysis& of, std::size_t i) {
    return dvec3(of.opponent[0][i], of.opponent[1][i], of.opponent[2][i]);
  };
  for (std::size_t i = 0; i < errors.size(); ++i)
    errors[i] = static_cast<float>(
        std::pow(color_error(opponent(a, i), opponent(b, i)), 1 - feature_error(a.features, b.features, i)));
  return errors;
}

double mean_flip(const Image& reference, const Image& test, double pixels_per_degree) {
  double sum = 0;
  const std::vector<float> errors = flip_map(reference, test, pixels_per_degree);
  for (float error : errors) sum += error;
  return errors.empty() ? 0 : sum / static_cast<double>(errors.size());
}

}  // namespace kdray::image
