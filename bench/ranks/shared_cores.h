// What    Queues that share cores, in virtual time: each of those at work gets the same speed, which depends
//         on how many they are.
// Shape   All that is at work goes on at the same speed, so one clock of work done tells when each ends: who
//         begins with so much work ends when the clock has come so much further.
// Units   Seconds; work in seconds of a core by itself.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

namespace kdray::bench {

class SharedCores {
 public:
  // `speed` of each of so many that are at work.
  using Speed = std::function<double(std::size_t at_work)>;
  explicit SharedCores(Speed speed) : speed_(std::move(speed)) {}

  void start(int who, double work) { at_work_.push({done_ + work, who}); }

  // When the next one ends, if none begins before; infinity: none is at work.
  double next_end() const {
    if (at_work_.empty()) return std::numeric_limits<double>::infinity();
    return now_ + (at_work_.top().first - done_) / speed_(at_work_.size());
  }

  // To a moment that is not behind the next end.
  void advance(double to) {
    if (!at_work_.empty()) done_ += (to - now_) * speed_(at_work_.size());
    now_ = to;
  }

  // One of those that end now, as far as the clock's bits tell.
  std::optional<int> take_ended() {
    if (at_work_.empty() || next_end() > now_ * (1 + 1e-14)) return std::nullopt;
    done_ = std::max(done_, at_work_.top().first);
    const int who = at_work_.top().second;
    at_work_.pop();
    return who;
  }

 private:
  using Job = std::pair<double, int>;
  Speed speed_;
  double now_ = 0, done_ = 0;
  std::priority_queue<Job, std::vector<Job>, std::greater<>> at_work_;
};

}  // namespace kdray::bench
