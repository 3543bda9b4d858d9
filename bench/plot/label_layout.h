// What    Places for labels beside their points, so that none covers another, a point or, where it can be
//         helped, a line.
// Shape   Pixels, y downwards. Greedy: the labels that matter most are placed first, each as near to its
//         point as it can be.
#pragma once

#include <optional>
#include <vector>

namespace kdray::bench {

struct Box {
  double x0, y0, x1, y1;
};

bool overlap(const Box& a, const Box& b);

class LabelLayout {
 public:
  explicit LabelLayout(const Box& bounds) : bounds_(bounds) {}

  void add_point(double x, double y, double radius);
  void add_line(double x0, double y0, double x1, double y1);

  struct Spot {
    Box box;
    bool far;  // so far from its point that a line should lead there
  };
  // Returns nothing where there is no room within `farthest` pixels.
  std::optional<Spot> place(double x, double y, double width, double height, double farthest,
                            bool may_cover_lines = true);

 private:
  bool is_free(const Box& box, double x, double y, bool over_lines) const;

  Box bounds_;
  std::vector<Box> taken_, lines_;
};

}  // namespace kdray::bench
