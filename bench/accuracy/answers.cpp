#include "bench/accuracy/answers.h"

#include <algorithm>
#include <cmath>

namespace kdray::bench {

namespace {

struct At {
  double error, seconds;
};

// Adaptive sampling's front, the largest error first.
std::vector<At> line_of(std::span<const AccuracyPoint> points) {
  std::vector<At> all, front;
  for (const AccuracyPoint& p : points)
    if (is_adaptive(p.group) && p.error.rmse > 0 && p.seconds.median > 0)
      all.push_back({p.error.rmse, p.seconds.median});
  std::sort(all.begin(), all.end(), [](const At& a, const At& b) {
    return a.seconds != b.seconds ? a.seconds < b.seconds : a.error < b.error;
  });
  for (const At& at : all)
    if (front.empty() || at.error < front.back().error) front.push_back(at);
  return front;
}

}  // namespace

std::optional<double> adaptive_seconds(std::span<const AccuracyPoint> points, double error) {
  const std::vector<At> line = line_of(points);
  if (line.empty() || !(error >= line.back().error)) return std::nullopt;
  const auto after = std::find_if(line.begin(), line.end(), [&](const At& at) { return at.error <= error; });
  if (after == line.begin()) return after->seconds;
  const At &from = *std::prev(after), &to = *after;
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
