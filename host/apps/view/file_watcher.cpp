#include "apps/view/file_watcher.h"

#include <sys/stat.h>

#include <utility>

namespace kdray::view {

FileWatcher::FileWatcher(std::vector<std::filesystem::path> files)
    : files_(std::move(files)), known_(state()), last_(known_) {}

std::string FileWatcher::state() const {
  std::string seen;
  for (const std::filesystem::path& file : files_) {
    struct stat info {};
    const bool there = ::stat(file.c_str(), &info) == 0;
    if (there)
      seen += std::to_string(info.st_ino) + " " + std::to_string(info.st_size) + " " +
              std::to_string(info.st_mtim.tv_sec) + "." + std::to_string(info.st_mtim.tv_nsec);
    seen += "\n";
  }
  return seen;
}

bool FileWatcher::changed() {
  std::string now = state();
  const bool settled = now == last_;
  last_ = std::move(now);
  if (!settled || last_ == known_) return false;
  known_ = last_;
  return true;
}

}  // namespace kdray::view
