// What    A thread for what would keep a picture waiting: reading scenes, PNGs, picks.
// Shape   The works are done one after the other, in order; only so many may wait, and more are not taken.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace kdray::view {

class Worker {
 public:
  explicit Worker(std::size_t most);
  ~Worker();  // drops what still waits
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // `work` must not throw. Returns false where too much is waiting.
  bool add(std::function<void()> work);

 private:
  void run();

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace kdray::view
