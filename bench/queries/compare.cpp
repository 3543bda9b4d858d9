#include "bench/queries/compare.h"

#include <algorithm>
#include <cmath>

namespace kdray::bench {

namespace {

bool far_apart(double a, double b, double width) {
  if (std::isfinite(a) != std::isfinite(b)) return true;
  return std::isfinite(a) && std::abs(a - b) > 1e-4 * std::max(std::abs(a), std::abs(b)) + 1e-6 * width;
}

// Those of the call's ray i.
bool crossings_differ(const AllHits& a, const AllHits& b, std::size_t i, double width) {
  const std::size_t n = a.splits[i + 1] - a.splits[i];
  if (n != b.splits[i + 1] - b.splits[i]) return true;
  for (std::size_t k = 0; k < n; ++k)
    if (far_apart(a.t[a.splits[i] + k], b.t[b.splits[i] + k], width)) return true;
  return false;
}

bool differ(Question question, const Answers& a, const Answers& b, std::size_t i, double width) {
  switch (question) {
    case Question::any:
    case Question::inside:
      return a.hit[i] != b.hit[i];
    case Question::count:
      return a.count[i] != b.count[i];
    default:
      return far_apart(a.t[i], b.t[i], width);
  }
}

}  // namespace

std::size_t count_differing(Question question, const Answers& a, const Answers& b, std::size_t first,
                            std::size_t n, double width) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < n; ++i)
    differing += question == Question::all ? crossings_differ(a.all, b.all, i, width)
                                           : differ(question, a, b, first + i, width);
  return differing;
}

}  // namespace kdray::bench
