#include "accel/kdtree/exact_clip.h"

namespace kdray::test {

namespace {

using FractionPoint = std::array<Fraction, 3>;

bool within(const Fraction& f, std::int64_t lo, std::int64_t hi) {
  return lo * f.denominator <= f.numerator && f.numerator <= hi * f.denominator;
}

class Clipper {
 public:
  Clipper(const std::array<Point, 3>& triangle, const Point& lo, const Point& hi)
      : t_(triangle), lo_(lo), hi_(hi) {
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      normal_[k] =
          (t_[1][i] - t_[0][i]) * (t_[2][j] - t_[0][j]) - (t_[1][j] - t_[0][j]) * (t_[2][i] - t_[0][i]);
    }
  }

  std::optional<ExactBounds> run() {
    for (int v = 0; v < 3; ++v) {
      add({Fraction{t_[v][0], 1}, Fraction{t_[v][1], 1}, Fraction{t_[v][2], 1}});
      for (int k = 0; k < 3; ++k) {
        add_edge(t_[v], t_[(v + 1) % 3], k, lo_[k]);
        add_edge(t_[v], t_[(v + 1) % 3], k, hi_[k]);
      }
    }
    for (int k = 0; k < 3; ++k) {
      for (const std::int64_t a : {lo_[(k + 1) % 3], hi_[(k + 1) % 3]}) {
        for (const std::int64_t b : {lo_[(k + 2) % 3], hi_[(k + 2) % 3]}) add_box_edge(k, a, b);
      }
    }
    return bounds_;
  }

 private:
  void add(const FractionPoint& p) {
    for (int k = 0; k < 3; ++k) {
      if (!within(p[k], lo_[k], hi_[k])) return;
    }
    if (!bounds_) {
      bounds_ = ExactBounds{p, p};
      return;
    }
    for (int k = 0; k < 3; ++k) {
      if (p[k] < bounds_->lo[k]) bounds_->lo[k] = p[k];
      if (bounds_->hi[k] < p[k]) bounds_->hi[k] = p[k];
    }
  }

  void add_edge(const Point& a, const Point& b, int axis, std::int64_t plane) {
    std::int64_t run = b[axis] - a[axis], at = plane - a[axis];
    if (run == 0) return;  // in the plane or beside it: its ends are added anyway
    if (run < 0) run = -run, at = -at;
    if (at < 0 || at > run) return;
    FractionPoint p;
    for (int k = 0; k < 3; ++k) p[k] = {a[k] * run + at * (b[k] - a[k]), run};
    add(p);
  }

  // The box's edge along `axis` at the other two coordinates (a, b), where it meets the triangle.
  void add_box_edge(int axis, std::int64_t a, std::int64_t b) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const std::int64_t n = normal_[axis];
    if (n == 0) return;  // edge-on: the crossings of the triangle's edges say it all
    for (int v = 0; v < 3; ++v) {
      const Point &p = t_[v], &q = t_[(v + 1) % 3];
      const std::int64_t side = (q[i] - p[i]) * (b - p[j]) - (q[j] - p[j]) * (a - p[i]);
      if (n > 0 ? side < 0 : side > 0) return;
    }
    std::int64_t top = n * t_[0][axis] - normal_[i] * (a - t_[0][i]) - normal_[j] * (b - t_[0][j]);
    FractionPoint p;
    p[i] = {a, 1};
    p[j] = {b, 1};
    p[axis] = n > 0 ? Fraction{top, n} : Fraction{-top, -n};
    add(p);
  }

  const std::array<Point, 3>& t_;
  const Point &lo_, &hi_;
  Point normal_;
  std::optional<ExactBounds> bounds_;
};

}  // namespace

bool operator<(const Fraction& a, const Fraction& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator;
}

std::optional<ExactBounds> exact_clip(const std::array<Point, 3>& triangle, const Point& lo,
                                      const Point& hi) {
  return Clipper(triangle, lo, hi).run();
}

}  // namespace kdray::test
