// What    Tells the other processes at a shared folder that this one lives, and this one whether they do.
// Shape   A file for each process, OWNER.beat, in which it counts, several times within a lease. Whoever
//         wants to know whether a process lives watches its file: a count that stays the same for a whole
//         lease, by the watcher's own clock, is that of a process that is gone; a process that leaves in
//         order removes its file.
// Why     Clocks of machines differ, and so do times of files on a server; a clock that only ever compares
//         itself with itself doesn't. A process that was only slow costs a tile made twice, never a wrong
//         one.
// Threads One thread counts; is_alive() is for one thread at a time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "base/temporary.h"

namespace kdray::checkpoint {

class Heartbeat {
 public:
  Heartbeat(std::filesystem::path folder, std::string owner, double lease_seconds);
  ~Heartbeat();

  const std::string& owner() const { return owner_; }

  // Of another process, or this one. One of which nothing is known yet counts as alive for a lease.
  bool is_alive(const std::string& owner);

 private:
  using Clock = std::chrono::steady_clock;
  struct Watched {
    std::string count;
    Clock::time_point since;
  };

  void beat();

  std::filesystem::path folder_;
  std::string owner_;
  std::chrono::duration<double> lease_;
  Temporary file_;
  std::uint64_t count_ = 0;
  std::map<std::string, Watched> watched_;
  std::mutex mutex_;
  std::condition_variable_any ends_;
  std::jthread thread_;
};

}  // namespace kdray::checkpoint
