// What    Records in a shared folder which process works on which things: each is free, leased, or done.
// Shape   Files: NAME-I.G is the G-th lease of thing I, with its owner's name in it; NAME-I.done says that it
//         is done. A lease whose owner is gone (Heartbeat) runs out: the next one is G + 1. Files are made
//         once and by one process (create_once), never changed or removed, so that there is no moment in
//         which two processes can get the same lease.
// Errors  ErrorCode::input when the folder can't be written.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/temporary.h"

namespace kdray::checkpoint {

// A small file that only one process can make, whole, in a folder that several machines see: what a
// checkpoint's header and its leases are. It is written under a name of its own and then linked to the one
// that is wanted, which fails where that is taken; where the file system has no links, it is made with
// O_EXCL and then written, so that readers may find it empty for a moment. Why: Both are atomic on NFS,
// where locks of files are not to be relied on. Errors: ErrorCode::input when the folder can't be written.

// False: there is such a file already.
bool create_once(const std::filesystem::path& file, std::string_view content);

// Nothing where there is no such file.
std::string read_small(const std::filesystem::path& file, std::size_t most);

// "node7-1234-89abcdef": no other process has the same, whatever machine it is on.
std::string new_owner();

// Tells the other processes at a shared folder that this one lives, and this one whether they do. A file
// for each process, OWNER.beat, in which it counts, several times within a lease. Whoever wants to know
// whether a process lives watches its file: a count that stays the same for a whole lease, by the watcher's
// own clock, is that of a process that is gone; a process that leaves in order removes its file. Why:
// Clocks of machines differ, and so do times of files on a server; a clock that only ever compares itself
// with itself doesn't. A process that was only slow costs a tile made twice, never a wrong one. Threads: one
// counts; is_alive() is for one thread at a time.
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

class Leases {
 public:
  // There are the things `first` to `first` + n.
  Leases(std::filesystem::path folder, std::string name, std::size_t first, std::size_t n,
         Heartbeat& heartbeat);

  // Looks how things stand now; what follows is of that moment.
  void look();

  std::size_t size() const { return things_.size(); }
  bool is_done(std::size_t i) const { return things_[i].done; }
  bool is_mine(std::size_t i) const { return things_[i].mine; }
  bool is_free(std::size_t i) const { return !things_[i].done && !things_[i].held; }
  bool all_done() const { return n_done() == things_.size(); }
  std::size_t n_done() const;

  // Whether someone had it before.
  bool was_held(std::size_t i) const { return things_[i].next > (things_[i].mine ? 1u : 0u); }

  // Takes a lease; false: another was faster.
  bool claim(std::size_t i);

  // Marks it done; false: another had.
  bool finish(std::size_t i);

 private:
  struct Thing {
    std::uint32_t next = 0;  // number of the next lease
    bool done = false, mine = false, held = false;
    std::string owner = {};        // of the last lease
    std::uint32_t owner_of = ~0u;  // ... if this is its number
  };

  std::filesystem::path file_of(std::size_t i, const std::string& ending) const;
  void read_name(const std::string& name);
  void find_owner(std::size_t i, std::map<std::string, bool>& alive);

  std::filesystem::path folder_;
  std::string name_;
  std::size_t first_;
  Heartbeat& heartbeat_;
  std::vector<Thing> things_;
};

}  // namespace kdray::checkpoint
