#include "base/temporary.h"

#include <mutex>
#include <set>
#include <system_error>
#include <utility>

namespace kdray {

namespace fs = std::filesystem;

namespace {

struct Known {
  std::mutex mutex;
  std::set<fs::path> paths;
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

Temporary::Temporary(fs::path path) : path_(std::move(path)) {
  const std::lock_guard lock(known().mutex);
  known().paths.insert(path_);
}

Temporary::~Temporary() {
  if (path_.empty()) return;
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
  for (const fs::path& path : known().paths) remove_whole(path);
}

}  // namespace kdray
