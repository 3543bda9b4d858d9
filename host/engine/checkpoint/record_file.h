// What    Reads the records of a file that its process may still be appending to.
// Shape   Each call goes on where the last one came to. What is no whole record is passed over when there is
//         one behind it: damage. At the end it is left: half a record that is still being written, or that
//         its process left when it was killed.
// Errors  None are thrown: a file that can't be read has no records.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <string>
#include <string_view>
#include <vector>

#include "engine/checkpoint/header.h"
#include "engine/checkpoint/record.h"

namespace kdray::checkpoint {

class RecordFile {
 public:
  // Only records of this frame count.
  RecordFile(std::filesystem::path path, const Hash& frame);
  ~RecordFile();
  RecordFile(RecordFile&& other) noexcept;
  RecordFile& operator=(RecordFile&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::string& maker() const { return maker_; }
  std::uint64_t damaged() const { return damaged_; }  // places where something was passed over
  std::uint64_t bytes_read() const { return offset_; }

  // `offset` is where the sums are in the file.
  using Take = std::function<void(const RecordHead& head, std::uint64_t offset, Sums sums)>;
  void read_on(const Take& take);

  // The sums of a record that was taken; false where they aren't there any more as they were.
  bool load(std::uint64_t offset, const Hash& content, std::span<layout::i64> sums) const;

 private:
  std::string_view at(std::uint64_t offset, std::size_t n);
  bool take_record(std::uint64_t offset, const Take& take, std::uint64_t& end);
  bool open();
  std::uint64_t find_next(std::uint64_t from);

  std::filesystem::path path_;
  Hash frame_;
  std::string maker_;
  int descriptor_ = -1;
  std::uint64_t offset_ = 0, damaged_ = 0, file_bytes_ = 0;
  std::vector<layout::i64> window_;  // of the file; words, so that sums are where words may be
  std::uint64_t window_offset_ = 0;
  std::size_t window_bytes_ = 0;
};

// The file that one process appends its finished tiles to: a header, then records. No other process writes
// it, and none goes on with it, so that a torn end has nothing behind it. Records that are finished
// together are one write(2). What was written survives the process, however it ends; what was synchronised
// survives the machine, too. Errors: ErrorCode::input when the file can't be written. append() after a
// failed one does nothing: records behind half a record are only found by a search.
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
