// What    What the queues of a frame did and when: rows of spans, written in the Chrome trace format
//         (Perfetto opens it).
// Shape   A row for each queue; a span has a name, a beginning and an end in seconds since the timeline was
//         made, and numbers of its own (rays in, rays out, tile). Spans of a row don't overlap; what lies
//         between them was idle.
// Threads Any number may add at once.
// Source  "Trace Event Format", Google: complete events ("ph": "X"), times in microseconds.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace kdray::timeline {

using Numbers = std::vector<std::pair<std::string, double>>;

struct Span {
  int row = 0;
  std::string name;
  double start = 0, end = 0;
  Numbers numbers;
};

class Timeline {
 public:
  using Clock = std::chrono::steady_clock;

  // Returns seconds since the timeline was made.
  double now() const { return seconds_at(Clock::now()); }
  double seconds_at(Clock::time_point time) const {
    return std::chrono::duration<double>(time - start_).count();
  }

  void name_row(int row, const std::string& name);
  void add(int row, const std::string& name, double start, double end, Numbers numbers = {});

  // Returns the spans of a row, in the order of their beginnings.
  std::vector<Span> spans(int row) const;

  std::string json() const;

 private:
  const Clock::time_point start_ = Clock::now();
  mutable std::mutex mutex_;
  std::vector<std::pair<int, std::string>> rows_;
  std::vector<Span> spans_;
};

}  // namespace kdray::timeline
