// What    What the points of bench accuracy say: which of them no other one beats, and of adaptive sampling
//         in what share of its time it is as near as the base, and how many times as long POV-Ray takes.
// Shape   A point is beaten by one that is no worse in both costs and better in one; of equal points the
//         first counts. What is not finite is never on the front.
//         Adaptive sampling's time at any error, read off straight lines between its points, both axes
//         logarithmic. At errors above its largest its fastest point counts; below its least there is no
//         answer.
#pragma once

#include <optional>

#include "bench/accuracy/bench.h"

namespace kdray::bench {

struct Cost {
  double seconds = 0, error = 0;
};

// The places in `costs` of the points on the Pareto front, from the fastest to the one of the least error.
std::vector<std::size_t> pareto_front(std::span<const Cost> costs);

void mark_front(std::vector<AccuracyPoint>& points);

// The fastest point of RMSE up to `error`; null where there is none.
const AccuracyPoint* fastest_within(std::span<const AccuracyPoint> points, double error);

struct AdaptiveAnswers {
  std::optional<double> share_of_base;  // of its seconds, at its error
  // POV-Ray's point with antialiasing at whose error it comes nearest to kdray; null: none that adaptive
  // sampling reaches.
  const AccuracyPoint* povray = nullptr;
  double times_povray = 0;  // its seconds, in adaptive sampling's at its error
};

AdaptiveAnswers adaptive_answers(const AccuracyRun& run);

// Seconds of adaptive sampling at an RMSE.
std::optional<double> adaptive_seconds(std::span<const AccuracyPoint> points, double error);

}  // namespace kdray::bench
