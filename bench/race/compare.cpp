#include "bench/race/compare.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace kdray::bench {

namespace {

bool far_apart(double a, double b, double width) {
  if (std::isfinite(a) != std::isfinite(b)) return true;
  return std::isfinite(a) && std::abs(a - b) > 1e-4 * std::max(std::abs(a), std::abs(b)) + 1e-6 * width;
}

bool lie_apart(const Hit& a, const Hit& b) {
  return far_apart(a.t, b.t, 0);
}

bool differ(const Hit& a, const Hit& b) {
  return lie_apart(a, b) && (!std::isfinite(a.t) || !std::isfinite(b.t) || a.primitive != b.primitive);
}

template <class Differ>
std::size_t count(std::span<const Hit> a, std::span<const Hit> b, Differ&& differ) {
  std::size_t n = std::max(a.size(), b.size()) - std::min(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) n += differ(a[i], b[i]) ? 1 : 0;
  return n;
}

template <class Differ>
double share(std::span<const Hit> a, std::span<const Hit> b, Differ&& differ) {
  const std::size_t n = std::max(a.size(), b.size());
  return n == 0 ? 0 : static_cast<double>(count(a, b, differ)) / static_cast<double>(n);
}

// Those of the call's ray i.
bool crossings_differ(const AllHits& a, const AllHits& b, std::size_t i, double width) {
  const std::size_t n = a.splits[i + 1] - a.splits[i];
  if (n != b.splits[i + 1] - b.splits[i]) return true;
  for (std::size_t k = 0; k < n; ++k)
    if (far_apart(a.t[a.splits[i] + k], b.t[b.splits[i] + k], width)) return true;
  return false;
}

bool answers_differ(Question question, const Answers& a, const Answers& b, std::size_t i, double width) {
  switch (question) {
    case Question::any:
    case Question::inside:
      return a.hit[i] != b.hit[i];
    case Question::count:
      return a.count[i] != b.count[i];
    default:
      return far_apart(a.t_of(i), b.t_of(i), width);
  }
}

}  // namespace

std::size_t count_hits(std::span<const Hit> hits) {
  return static_cast<std::size_t>(
      std::ranges::count_if(hits, [](const Hit& h) { return std::isfinite(h.t); }));
}

std::size_t count_not_identical(std::span<const Hit> a, std::span<const Hit> b) {
  return count(a, b, [](const Hit& x, const Hit& y) { return std::memcmp(&x, &y, sizeof(Hit)) != 0; });
}

double differing_share(std::span<const Hit> a, std::span<const Hit> b) {
  return share(a, b, differ);
}

double differing_distances(std::span<const Hit> a, std::span<const Hit> b) {
  return share(a, b, lie_apart);
}

std::size_t count_differing(Question question, const Answers& a, const Answers& b, std::size_t first,
                            std::size_t n, double width) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < n; ++i)
    differing += question == Question::all ? crossings_differ(a.all, b.all, i, width)
                                           : answers_differ(question, a, b, first + i, width);
  return differing;
}

}  // namespace kdray::bench
