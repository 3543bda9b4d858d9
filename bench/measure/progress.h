// What    How a bench tells of itself while it runs, and how it goes through its scenes.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace kdray::bench {

using Working = std::function<void(const std::string&)>;

template <class Run>
struct Progress {
  std::function<void(const Run&)> done;  // hears of every run as soon as it has ended
  Working working;                       // hears what is being measured
};

// Returns measure(item) of each.
template <class Run, class Items, class Measure>
std::vector<Run> run_each(const Items& items, const Progress<Run>& progress, const Measure& measure) {
  std::vector<Run> runs;
  for (const auto& item : items) {
    runs.push_back(measure(item));
    progress.done(runs.back());
  }
  return runs;
}

// Returns Bench(options, scene).run() of each of its scenes, told of before.
template <class Bench, class Run, class Options>
std::vector<Run> run_scenes(const Options& options, const Progress<Run>& progress) {
  return run_each(options.scenes, progress, [&](const std::string& scene) {
    progress.working(scene);
    return Bench(options, scene).run();
  });
}

// Returns the sum of count(run) over all runs: of what has to be 0.
template <class Runs, class Count>
std::size_t count_over(const Runs& runs, const Count& count) {
  std::size_t n = 0;
  for (const auto& run : runs) n += count(run);
  return n;
}

}  // namespace kdray::bench
