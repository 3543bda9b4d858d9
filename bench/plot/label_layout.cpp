#include "bench/plot/label_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace kdray::bench {

namespace {

constexpr double kNear = 8;  // from the point's centre to the label's edge
constexpr std::array kDistances = {kNear, 15.0, 24.0, 36.0, 50.0, 68.0, 90.0, 115.0};
constexpr int kDirections = 16;

// Right first, then up and down from there.
double direction(int i) {
  const int turns = (i + 1) / 2 * (i % 2 == 0 ? 1 : -1);
  return 2 * std::numbers::pi * turns / kDirections;
}

bool contains(const Box& box, double x, double y) {
  return x > box.x0 && x < box.x1 && y > box.y0 && y < box.y1;
}

// Whether the line from a point to the middle of a label passes through `box`.
bool is_crossed(const Box& box, double x, double y, const Box& label) {
  const double mx = (label.x0 + label.x1) / 2, my = (label.y0 + label.y1) / 2;
  for (double t = 0.15; t < 1; t += 0.05)
    if (contains(box, x + t * (mx - x), y + t * (my - y))) return true;
  return false;
}

}  // namespace

bool overlap(const Box& a, const Box& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

void LabelLayout::add_point(double x, double y, double radius) {
  taken_.push_back({x - radius, y - radius, x + radius, y + radius});
}

void LabelLayout::add_line(double x0, double y0, double x1, double y1) {
  lines_.push_back({std::min(x0, x1) - 1, std::min(y0, y1) - 1, std::max(x0, x1) + 1, std::max(y0, y1) + 1});
}

bool LabelLayout::is_free(const Box& box, double x, double y, bool over_lines) const {
  if (box.x0 < bounds_.x0 || box.x1 > bounds_.x1 || box.y0 < bounds_.y0 || box.y1 > bounds_.y1) return false;
  const auto hits = [&](const Box& b) { return overlap(b, box); };
  if (!over_lines && std::any_of(lines_.begin(), lines_.end(), hits)) return false;
  return std::none_of(taken_.begin(), taken_.end(), [&](const Box& b) {
    return overlap(b, box) || (!contains(b, x, y) && is_crossed(b, x, y, box));
  });
}

std::optional<LabelLayout::Spot> LabelLayout::place(double x, double y, double width, double height,
                                                    double farthest, bool may_cover_lines) {
  for (const bool over_lines : {false, true}) {
    if (over_lines && !may_cover_lines) break;
    for (const double distance : kDistances)
      for (int i = 0; i < kDirections && distance <= farthest; ++i) {
        const double dx = std::cos(direction(i)), dy = std::sin(direction(i));
        const double cx = x + dx * (distance + width / 2), cy = y + dy * (distance + height / 2);
        const Box box = {cx - width / 2, cy - height / 2, cx + width / 2, cy + height / 2};
        if (!is_free(box, x, y, over_lines)) continue;
        taken_.push_back(box);
        return Spot{box, distance > kNear};
      }
  }
  return std::nullopt;
}

}  // namespace kdray::bench
