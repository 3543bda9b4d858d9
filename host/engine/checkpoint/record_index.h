// What    All records of a frame that a folder holds, whichever processes wrote them: of which tiles and runs
//         there are some, and where.
// Shape   The files of others are read on; what this process writes itself is added as it writes it. Of
//         two records of one tile or run the first counts.
// Errors  ErrorCode::input where two records of one tile or run differ: a machine computes wrongly.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/checkpoint/record_file.h"

namespace kdray::checkpoint {

class RecordIndex {
 public:
  // `own` is the file of this process, which isn't read, and which begins with `header`.
  RecordIndex(std::filesystem::path folder, const Header& header, std::filesystem::path own);

  // Looks for what the others have added, and calls `take` with each record that was not known.
  using Take = std::function<void(const RecordId& id, Sums sums)>;
  void read_on(const Take& take);

  // A record that this process has made.
  void add(const RecordId& id, const Hash& content);

  // The sums of a record that another process has made; false: there are none of just these places.
  bool load(const RecordId& id, std::span<layout::i64> sums) const;

  std::uint64_t damaged() const;
  std::uint64_t bytes_read() const;

 private:
  static constexpr std::size_t kOwn = static_cast<std::size_t>(-1);
  struct Known {
    Rectangle places;
    Hash content;
    std::size_t file;
    std::uint64_t offset;
  };

  void find_files();
  bool note(const RecordId& id, const Known& known);
  std::string maker_of(std::size_t file) const;

  std::filesystem::path folder_;
  Header header_;
  Hash frame_;
  std::filesystem::path own_;
  std::vector<RecordFile> files_;
  std::unordered_map<std::uint64_t, Known> known_;  // by round and number
};

}  // namespace kdray::checkpoint
