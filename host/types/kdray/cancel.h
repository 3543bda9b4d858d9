// What    Tells a query or a picture to end, from any thread.
// Errors  The call that is told so throws ErrorCode::cancelled within a tenth of a second or so; what it had
//         begun is lost, and what it worked on is as it was.
#pragma once

#include <atomic>
#include <memory>

namespace kdray {

// Copies are one: the caller keeps one and gives one.
class Cancel {
 public:
  void cancel() { asked_->store(true, std::memory_order_relaxed); }
  bool is_cancelled() const { return asked_->load(std::memory_order_relaxed); }

 private:
  std::shared_ptr<std::atomic<bool>> asked_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace kdray
