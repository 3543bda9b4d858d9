#include "base/temporary.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <map>
#include <mutex>
#include <random>
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

// The lock is never released: nothing new may be made between this and the end.
void remove_temporaries() {
  known().mutex.lock();
  for (const auto& [path, process] : known().paths)
    if (process == ::getpid()) remove_whole(path);
}

namespace {

// Returns the number of the process in a folder's name; 0 where there is none.
int process_of(const std::string& name, const std::string& prefix) {
  int process = 0;
  if (!name.starts_with(prefix)) return 0;
  const auto [end, error] = std::from_chars(name.data() + prefix.size(), name.data() + name.size(), process);
  return error == std::errc() && *end == '-' ? process : 0;
}

// Removes what processes that were killed have left behind.
void sweep(const fs::path& where, const std::string& prefix) {
  std::error_code error;
  for (fs::directory_iterator i(where, error), end; !error && i != end; i.increment(error)) {
    const int process = process_of(i->path().filename().string(), prefix);
    struct stat status {};
    if (process <= 0 || ::lstat(i->path().c_str(), &status) != 0 || status.st_uid != ::geteuid()) continue;
    std::error_code ignored;
    if (::kill(process, 0) != 0 && errno == ESRCH) fs::remove_all(i->path(), ignored);
  }
}

}  // namespace

std::unique_ptr<Temporary> make_temporary_folder(const std::string& prefix) {
  std::error_code error;
  const fs::path where = fs::temp_directory_path(error);
  return error ? nullptr : make_temporary_folder(prefix, where);
}

std::unique_ptr<Temporary> make_temporary_folder(const std::string& prefix, const fs::path& where) {
  sweep(where, prefix);
  auto folder = std::make_unique<Temporary>(
      where / fmt::format("{}{}-{:08x}", prefix, ::getpid(), std::random_device()()));
  if (::mkdir(folder->path().c_str(), 0700) == 0) return folder;
  folder->forget();
  return nullptr;
}

}  // namespace kdray
