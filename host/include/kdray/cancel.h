// What    Tells a query or a picture to end: from any thread, or by a question that it asks now and then.
// Errors  The call that is told so throws ErrorCode::cancelled when the launch in work has ended: mostly
//         within a tenth of a second, however many hits rays have. The scene is as it was; answers may be
//         half written.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <utility>

namespace kdray {

// Copies are one: the caller keeps one and gives one.
class Cancel {
 public:
  Cancel() = default;
  // Ends the call too when `asked` answers true. It is called by the thread whose call it may end, between
  // launches; it must not throw. (For programs that learn of Ctrl-C only when they ask for it.)
  explicit Cancel(std::function<bool()> asked) : state_(std::make_shared<State>(std::move(asked))) {}

  void cancel() { state_->cancelled.store(true, std::memory_order_relaxed); }
  bool is_cancelled() const {
    return state_->cancelled.load(std::memory_order_relaxed) || (state_->also && state_->also());
  }

 private:
  struct State {
    explicit State(std::function<bool()> question = {}) : also(std::move(question)) {}
    std::atomic<bool> cancelled{false};
    const std::function<bool()> also;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace kdray
