#include "base/cache_folder.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace kdray {

namespace fs = std::filesystem;

namespace {

struct Entry {
  fs::path file;
  fs::file_time_type used;
  std::uint64_t bytes;
};

bool is_entry(const std::string& name, std::string_view ending) {
  return name.size() == 32 + ending.size() && name.ends_with(ending) &&
         name.find_first_not_of("0123456789abcdef") == 32;
}

// Temporaries are named by write_atomically. One that has not changed for an hour was left behind, since no
// writer takes that long.
bool is_left_behind(const std::string& name, std::string_view ending, fs::file_time_type changed) {
  return name.starts_with(".kdray-") && name.ends_with(ending) &&
         fs::file_time_type::clock::now() - changed > std::chrono::hours(1);
}

// Lists the entries. Others may come and go at the same time, which is no error.
std::vector<Entry> entries_in(const fs::path& folder, std::string_view ending) {
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;
    const std::string name = at->path().filename().string();
    const Entry entry{at->path(), at->last_write_time(gone), at->file_size(gone)};
    if (gone) continue;
    if (is_entry(name, ending)) entries.push_back(entry);
    if (is_left_behind(name, ending, entry.used)) fs::remove(entry.file, gone);
  }
  return entries;
}

}  // namespace

// A relative path in these variables counts as none.
fs::path user_cache_folder() {
  if (const char* const caches = std::getenv("XDG_CACHE_HOME"); caches && fs::path(caches).is_absolute())
    return fs::path(caches) / "kdray";
  if (const char* const home = std::getenv("HOME"); home && fs::path(home).is_absolute())
    return fs::path(home) / ".cache" / "kdray";
  return {};
}

fs::path entry_file(const fs::path& folder, const Hash& key, std::string_view ending) {
  return folder / (in_hex(key) + std::string(ending));
}

std::vector<Hash> keys_in(const fs::path& folder, std::string_view ending) {
  std::vector<Hash> keys;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (!is_entry(name, ending)) continue;
    keys.push_back(
        {std::stoull(name.substr(0, 16), nullptr, 16), std::stoull(name.substr(16, 16), nullptr, 16)});
  }
  return keys;
}

void touch_entry(const fs::path& entry) {
  ::utimensat(AT_FDCWD, entry.c_str(), nullptr, 0);
}

void shrink_folder(const fs::path& folder, std::string_view ending, std::uint64_t max_bytes) {
  std::vector<Entry> entries = entries_in(folder, ending);
  std::ranges::sort(entries, std::ranges::greater(), &Entry::used);
  std::uint64_t total = 0;
  for (const Entry& entry : entries) {
    total += entry.bytes;
    std::error_code error;  // another process may have been faster
    if (total > max_bytes) fs::remove(entry.file, error);
  }
}

}  // namespace kdray
