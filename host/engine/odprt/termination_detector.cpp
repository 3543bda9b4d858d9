#include "engine/odprt/termination_detector.h"

namespace kdray::odprt {

bool TerminationDetector::answer(std::size_t rank, std::uint32_t wave, const WorkMessages& count) {
  if (!is_asking() || wave != wave_ || answers_[rank]) return false;
  answers_[rank] = count;
  if (++n_answers_ == answers_.size()) complete();
  return true;
}

void TerminationDetector::complete() {
  WorkMessages sum;
  for (std::optional<WorkMessages>& answer : answers_) {
    sum.sent += answer->sent;
    sum.received += answer->received;
    answer.reset();
  }
  is_over_ = sum.sent == sum.received && last_ == sum;
  last_ = sum;
  n_answers_ = 0;
  n_complete_ = wave_;
}

}  // namespace kdray::odprt
