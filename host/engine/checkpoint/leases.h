// What    Records in a shared folder which process works on which things: each is free, leased, or done.
// Shape   Files: NAME-I.G is the G-th lease of thing I, with its owner's name in it; NAME-I.done says that it
//         is done. A lease whose owner is gone (heartbeat.h) runs out: the next one is G + 1. Files are made
//         once and by one process (create_once.h), never changed or removed, so that there is no moment in
//         which two processes can get the same lease.
// Errors  ErrorCode::input when the folder can't be written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/checkpoint/heartbeat.h"

namespace kdray::checkpoint {

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
