// What    Kernels with their queues and buffers, kept from one call of a query for the next, one for each
//         call that goes on at a time.
// Shape   A session is whatever is made of a Target and has settle(), which waits for what may still be
//         running on it, and says whether it can serve again. It serves one call at a time, from any thread.
// Why     Small batches: making a kernel, its buffers and its first launch takes a hundred times what one ray
//         takes.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "engine/query/target.h"

namespace kdray::query {

template <class Session>
class Sessions {
 public:
  // The target has to outlive it.
  explicit Sessions(const Target& target) : target_(&target) {}

  // A session, given back when the pointer goes.
  class Give {
   public:
    explicit Give(Sessions* to = nullptr) : to_(to) {}
    void operator()(Session* session) const { to_->take_back(std::unique_ptr<Session>(session)); }

   private:
    Sessions* to_;
  };
  using Borrowed = std::unique_ptr<Session, Give>;

  Borrowed borrow() {
    std::unique_ptr<Session> session;
    if (const std::lock_guard lock(mutex_); !free_.empty()) {
      session = std::move(free_.back());
      free_.pop_back();
    }
    if (!session) session = std::make_unique<Session>(*target_);  // which may compile: others go on
    return {session.release(), Give(this)};
  }

 private:
  void take_back(std::unique_ptr<Session> session) {
    if (!session->settle()) return;
    const std::lock_guard lock(mutex_);
    try {
      free_.push_back(std::move(session));
    } catch (const std::bad_alloc&) {  // the next one is made anew
    }
  }

  const Target* target_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Session>> free_;
};

}  // namespace kdray::query
