#include "bench/accuracy/answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace kdray::bench {

namespace {

// Adaptive sampling's front, the largest error first.
std::vector<Cost> line_of(std::span<const AccuracyPoint> points) {
  std::vector<Cost> all, front;
  for (const AccuracyPoint& p : points)
    if (is_adaptive(p.group) && p.error.rmse > 0 && p.seconds.median > 0)
      all.push_back({p.seconds.median, p.error.rmse});
  for (const std::size_t i : pareto_front(all)) front.push_back(all[i]);
  return front;
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const Cost> costs) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < costs.size(); ++i)
    if (std::isfinite(costs[i].seconds) && std::isfinite(costs[i].error)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(costs[a].seconds, costs[a].error, a) < std::tie(costs[b].seconds, costs[b].error, b);
  });
  // From the fastest on, a point is on the front where its error is below that of all before.
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (costs[i].error >= least) continue;
    front.push_back(i);
    least = costs[i].error;
  }
  return front;
}

void mark_front(std::vector<AccuracyPoint>& points) {
  std::vector<Cost> costs;
  for (const AccuracyPoint& p : points) costs.push_back({p.seconds.median, p.error.rmse});
  for (const std::size_t i : pareto_front(costs)) points[i].on_front = true;
}

const AccuracyPoint* fastest_within(std::span<const AccuracyPoint> points, double error) {
  const AccuracyPoint* best = nullptr;
  for (const AccuracyPoint& p : points)
    if (p.error.rmse <= error && (best == nullptr || p.seconds.median < best->seconds.median)) best = &p;
  return best;
}

std::optional<double> adaptive_seconds(std::span<const AccuracyPoint> points, double error) {
  const std::vector<Cost> line = line_of(points);
  if (line.empty() || !(error >= line.back().error)) return std::nullopt;
  const auto after =
      std::find_if(line.begin(), line.end(), [&](const Cost& at) { return at.error <= error; });
  if (after == line.begin()) return after->seconds;
  const Cost &from = *std::prev(after), &to = *after;
  const double share = std::log(from.error / error) / std::log(from.error / to.error);
  return from.seconds * std::pow(to.seconds / from.seconds, share);
}

AdaptiveAnswers adaptive_answers(const AccuracyRun& run) {
  AdaptiveAnswers answers;
  const AccuracyPoint& base = run.points.front();
  if (const auto seconds = adaptive_seconds(run.points, base.error.rmse); seconds && base.seconds.median > 0)
    answers.share_of_base = *seconds / base.seconds.median;
  if (!run.povray) return answers;
  for (const AccuracyPoint& p : run.povray->points) {
    if (p.name.rfind("-A", 0) == 0) continue;  // without antialiasing
    const auto seconds = adaptive_seconds(run.points, p.error.rmse);
    if (!seconds) continue;
    const double times = p.seconds.median / *seconds;
    if (answers.povray == nullptr || times < answers.times_povray)
      answers.povray = &p, answers.times_povray = times;
  }
  return answers;
}

}  // namespace kdray::bench
