// What    The file that one process appends its finished tiles to: a header, then records. No other process
//         writes it, and none goes on with it, so that a torn end has nothing behind it.
// Shape   Records that are finished together are one write(2). What was written survives the process, however
//         it ends; what was synchronised survives the machine, too.
// Errors  ErrorCode::input when the file can't be written. append() after a failed one does nothing: records
//         behind half a record are only found by a search.
#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <string_view>

#include "engine/checkpoint/header.h"

namespace kdray::checkpoint {

inline constexpr const char* kTilesEnding = ".tiles";

class TileFile {
 public:
  TileFile(const std::filesystem::path& folder, const std::string& owner, const Header& header);
  ~TileFile();
  TileFile(const TileFile&) = delete;
  TileFile& operator=(const TileFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  void append(std::string_view records);
  void sync();            // waits until what was appended is on the disk, and seen by other machines
  void sync_meanwhile();  // lets the system begin with it, and doesn't wait

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  bool failed_ = false;
  std::future<void> syncing_;
};

}  // namespace kdray::checkpoint
