// What    Tells a query or a picture to end, from any thread.
// Errors  The call that is told so throws ErrorCode::cancelled when the launch in work has ended: mostly
//         within a tenth of a second, later where rays have very many hits each. The scene is as it was;
//         answers may be half written.
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
