#include "engine/checkpoint/record_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace kdray::checkpoint {

namespace {

constexpr std::size_t kWindow = std::size_t{1} << 20;

// Reads n bytes, or what there is of them.
std::size_t read_at(int descriptor, void* to, std::size_t n, std::uint64_t offset) {
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got =
        ::pread(descriptor, static_cast<char*>(to) + done, n - done, static_cast<off_t>(offset + done));
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

}  // namespace

RecordFile::RecordFile(std::filesystem::path path, const Hash& frame)
    : path_(std::move(path)), frame_(frame) {}

RecordFile::~RecordFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

RecordFile::RecordFile(RecordFile&& other) noexcept
    : path_(std::move(other.path_)),
      frame_(other.frame_),
      maker_(std::move(other.maker_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      offset_(other.offset_),
      damaged_(other.damaged_) {}

// The file's bytes from there on: n, or fewer at its end.
std::string_view RecordFile::at(std::uint64_t offset, std::size_t n) {
  if (offset >= file_bytes_) return {};
  n = static_cast<std::size_t>(std::min<std::uint64_t>(n, file_bytes_ - offset));
  if (offset < window_offset_ || offset + n > window_offset_ + window_bytes_) {
    const std::size_t wanted = std::min<std::uint64_t>(std::max(n, kWindow), file_bytes_ - offset);
    window_.resize(std::max(window_.size(), wanted / sizeof(layout::i64) + 1));
    window_offset_ = offset;
    window_bytes_ = read_at(descriptor_, window_.data(), wanted, offset);
  }
  const std::size_t first = offset - window_offset_;
  return {reinterpret_cast<const char*>(window_.data()) + first, std::min(n, window_bytes_ - first)};
}

bool RecordFile::take_record(std::uint64_t offset, const Take& take, std::uint64_t& end) {
  const std::optional<RecordHead> head = head_of(at(offset, kRecordHead), frame_);
  if (!head) return false;
  const std::size_t n = head->bytes - kRecordHead;
  if (n > file_bytes_) return false;
  const std::string_view body = at(offset + kRecordHead, n);
  if (body.size() != n) return false;
  const Sums sums(reinterpret_cast<const layout::i64*>(body.data()), n / sizeof(layout::i64));
  if (hash_of_sums(sums) != head->content) return false;
  end = offset + head->bytes;
  if (take) take(*head, offset + kRecordHead, sums);
  return true;
}

// Of a whole record; 0: there is none.
std::uint64_t RecordFile::find_next(std::uint64_t from) {
  for (std::uint64_t offset = from;;) {
    const std::string_view bytes = at(offset, kWindow);
    const std::size_t found = find_record(bytes, 0);
    if (found == std::string_view::npos) {
      if (bytes.size() < kWindow) return 0;
      offset += kWindow;
      continue;
    }
    std::uint64_t end = 0;
    if (take_record(offset + found, {}, end)) return offset + found;
    offset += found + 8;
  }
}

// Each time anew: that is when NFS looks what is new.
bool RecordFile::open() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  window_bytes_ = 0;
  struct stat facts {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &facts) != 0) return false;
  file_bytes_ = static_cast<std::uint64_t>(facts.st_size);
  if (offset_ > 0) return true;
  const std::optional<Header> header = header_of(at(0, kHeaderBytes));
  if (header) maker_ = header->maker;
  // A damaged header costs no record: each names its frame.
  offset_ = at(0, kHeaderBytes).size() == kHeaderBytes ? kHeaderBytes : 0;
  return offset_ > 0;
}

void RecordFile::read_on(const Take& take) {
  if (!open()) return;
  for (std::uint64_t end = 0;;) {
    if (take_record(offset_, take, end)) {
      offset_ = end;
      continue;
    }
    if (at(offset_, 8).size() < 8) return;
    const std::uint64_t next = find_next(offset_ + 8);
    if (next == 0) return;
    ++damaged_;
    offset_ = next;
  }
}

bool RecordFile::load(std::uint64_t offset, const Hash& content, std::span<layout::i64> sums) const {
  return read_at(descriptor_, sums.data(), sums.size_bytes(), offset) == sums.size_bytes() &&
         hash_of_sums(sums) == content;
}

namespace {

Error cannot_write(const std::filesystem::path& file, int error) {
  return input_error(
      file.string(), 0, fmt::format("can't be written ({})", std::strerror(error)),
      error == ENOSPC || error == EDQUOT ? "free some space, then go on from what is kept" : "");
}

}  // namespace

TileFile::TileFile(const std::filesystem::path& folder, const std::string& owner, const Header& header)
    : path_(folder / (owner + kTilesEnding)),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw cannot_write(path_, errno);
  try {
    append(to_bytes(header));
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

TileFile::~TileFile() {
  if (syncing_.valid()) syncing_.wait();
  ::close(descriptor_);
}

void TileFile::append(std::string_view records) {
  if (failed_) return;
  while (!records.empty()) {
    const ssize_t n = ::write(descriptor_, records.data(), records.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      failed_ = true;
      throw cannot_write(path_, errno);
    }
    records.remove_prefix(static_cast<std::size_t>(n));
  }
}

void TileFile::sync() {
  if (syncing_.valid()) syncing_.wait();
  if (!failed_ && ::fdatasync(descriptor_) != 0 && errno != EINVAL) throw cannot_write(path_, errno);
}

void TileFile::sync_meanwhile() {
  using namespace std::chrono_literals;
  if (syncing_.valid() && syncing_.wait_for(0s) != std::future_status::ready) return;
  syncing_ = std::async(std::launch::async, [this] { (void)::fdatasync(descriptor_); });
}

}  // namespace kdray::checkpoint
