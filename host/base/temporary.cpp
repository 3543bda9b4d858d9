#include "base/temporary.h"

#include <unistd.h>

#include <map>
#include <mutex>
#include <system_error>
#include <utility>

namespace kdray {

namespace fs = std::filesystem;

namespace {

struct Known {
  std::mutex mutex;
  std::map<fs::path, pid_t> paths;  // by whose process
};

// Never destroyed: static objects may own temporaries.
Known& known() {
  static Known* const all = new Known;
  return *all;
}

void remove_whole(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
}

}  // namespace

Temporary::Temporary(fs::path path) : path_(std::move(path)), process_(::getpid()) {
  const std::lock_guard lock(known().mutex);
  known().paths.emplace(path_, process_);
}

Temporary::~Temporary() {
  if (path_.empty() || process_ != ::getpid()) return;
  const std::lock_guard lock(known().mutex);
  remove_whole(path_);
  known().paths.erase(path_);
}

void Temporary::forget() {
  const std::lock_guard lock(known().mutex);
  known().paths.erase(path_);
  path_.clear();
}

// The lock is never given back: nothing new may be made between this and the end.
void remove_temporaries() {
  known().mutex.lock();
  for (const auto& [path, process] : known().paths)
    if (process == ::getpid()) remove_whole(path);
}

}  // namespace kdray
