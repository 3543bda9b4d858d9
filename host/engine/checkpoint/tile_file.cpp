#include "engine/checkpoint/tile_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace kdray::checkpoint {

namespace {

Error cannot_write(const std::filesystem::path& file, int error) {
  return input_error(file.string(), 0, fmt::format("can't be written ({})", std::strerror(error)),
                     error == ENOSPC || error == EDQUOT ? "free some space, then go on with --resume" : "");
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
