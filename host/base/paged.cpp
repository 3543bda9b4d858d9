#include "base/paged.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cinttypes>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/memory.h"
#include "base/process_memory.h"

namespace kdray {

// ---- files without a name: memory whose pages the system may write out at any time

namespace {

// Not every file system knows files that never had a name; there one is removed at once.
int open_nameless(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0 || errno == ENOENT || errno == EACCES || errno == ENOTDIR) return file;
  std::string name = (folder / "kdray-XXXXXX").string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

void* map_space(int file, std::size_t bytes) {
  if (const int error = ::posix_fallocate(file, 0, static_cast<off_t>(bytes)); error != 0) {
    errno = error;
    return nullptr;
  }
  void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  return memory == MAP_FAILED ? nullptr : memory;
}

// Returns zeroed memory from the start of a page; null, with errno, where there can be none. The file's space
// is taken at once, so that a full disk is an error here and ends no process later.
std::shared_ptr<void> map_nameless_file(const std::filesystem::path& folder, std::size_t bytes) {
  const int file = open_nameless(folder);
  if (file < 0) return nullptr;
  void* const memory = map_space(file, bytes);
  const int error = errno;
  ::close(file);
  errno = error;
  if (memory == nullptr) return nullptr;
  return {memory, [bytes](void* p) { ::munmap(p, bytes); }};
}

}  // namespace

// ---- how much of mapped files this process has in memory: proc(5), statm and smaps

namespace {

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Stream open_own(const char* name) {
  return {std::fopen(name, "re"), std::fclose};
}

// Returns the bytes of the ranges that lie from `begin` to `end`.
std::uint64_t within(const std::map<void*, std::size_t>& ranges, std::uintptr_t begin, std::uintptr_t end) {
  std::uint64_t sum = 0;
  for (auto r = ranges.lower_bound(reinterpret_cast<void*>(begin)); r != ranges.end(); ++r) {
    if (reinterpret_cast<std::uintptr_t>(r->first) >= end) break;
    sum += r->second;
  }
  return sum;
}

// Returns the bytes of all mapped files; takes microseconds. 0 where the system doesn't say.
std::uint64_t resident_of_files() {
  const Stream file = open_own("/proc/self/statm");
  std::uint64_t pages = 0;
  if (!file || std::fscanf(file.get(), "%*u %*u %" SCNu64, &pages) != 1) return 0;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

// Returns the bytes of these ranges, each given by its first byte and its size: a whole mapping or the inner
// part of one (which counts by what the whole has, and no more than its size). Takes milliseconds for many
// gigabytes.
std::uint64_t resident_of(const std::map<void*, std::size_t>& ranges) {
  const Stream file = open_own("/proc/self/smaps");
  if (!file) return 0;
  std::uint64_t sum = 0, ours = 0;
  char line[4096];
  while (std::fgets(line, sizeof line, file.get()) != nullptr) {
    std::uintptr_t begin = 0, end = 0;
    std::uint64_t kilobytes = 0;
    if (std::sscanf(line, "%" SCNxPTR "-%" SCNxPTR " ", &begin, &end) == 2)
      ours = within(ranges, begin, end);
    else if (ours > 0 && std::sscanf(line, "Rss: %" SCNu64, &kilobytes) == 1)
      sum += std::min(ours, kilobytes * 1024);
  }
  return sum;
}

}  // namespace

// ---- the budget, and what is let go

namespace {

constexpr std::size_t kLeast = std::size_t{1} << 20;  // smaller blocks are plain, and not counted
constexpr auto kPause = std::chrono::milliseconds(5);
constexpr int kMostPassedOver = 100;

// All paged memory of the process.
class Pages {
 public:
  // Never destroyed: what owns memory may outlive static objects, and so does the thread.
  static Pages& all() {
    static Pages* const pages = new Pages;
    return *pages;
  }

  void set_budget(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    budget_ = bytes;
    is_set_ = true;
  }
  bool is_set() {
    const std::lock_guard lock(mutex_);
    return is_set_;
  }

  // Returns whether plain memory may have so much more.
  bool fits(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t most = budget() / 4 * 3;
    return plain_ <= most && bytes <= most - plain_;
  }
  void count_plain(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    plain_ += bytes;
  }
  void forget_plain(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    plain_ -= bytes;
  }

  void add_file(void* memory, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    files_[memory] = bytes;
    if (!watched_) std::thread([this] { watch(); }).detach();
    watched_ = true;
    changed_.notify_one();
  }
  // Once this returns, nothing here touches that memory any more.
  void remove_file(void* memory) {
    const std::lock_guard lock(mutex_);
    files_.erase(memory);
  }

  PagedBytes bytes() {
    const std::lock_guard lock(mutex_);
    PagedBytes out{.plain = plain_, .in_files = 0, .in_memory = resident_of(files_)};
    for (const auto& [memory, bytes] : files_) out.in_files += bytes;
    return out;
  }

 private:
  Pages() = default;

  std::uint64_t budget() {
    if (!budget_) budget_ = free_memory() / 2;
    return *budget_;
  }

  [[noreturn]] void watch() {
    for (std::unique_lock lock(mutex_);;) {
      changed_.wait(lock, [&] { return !files_.empty(); });
      let_go_of_many();
      changed_.wait_for(lock, kPause);
    }
  }

  // The size of all mapped files is quick to get, that of these alone much slower: so these are measured only
  // when all have grown by enough for these to have come near their share. Others write meanwhile: what
  // counts as seen was there before these were measured, and nothing once they are let go. The quick size
  // lags behind by some pages a processor, so these are measured from time to time in any case.
  void let_go_of_many() {
    const std::uint64_t share = budget() / 4, now = resident_of_files();
    if (now < seen_ + share / 8 && ++passed_over_ < kMostPassedOver) {
      seen_ = std::min(seen_, now);
      return;
    }
    passed_over_ = 0;
    seen_ = now;
    if (resident_of(files_) <= share) return;
    for (const auto& [memory, bytes] : files_) ::madvise(memory, bytes, MADV_DONTNEED);
    seen_ = 0;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::uint64_t> budget_;
  bool is_set_ = false, watched_ = false;
  std::uint64_t plain_ = 0;
  std::map<void*, std::size_t> files_;
  std::uint64_t seen_ = 0;  // of all mapped files, when these were looked at
  int passed_over_ = 0;     // pauses since then
};

std::filesystem::path folder_of_files() {
  const char* const folder = std::getenv("TMPDIR");
  return folder != nullptr && *folder != '\0' ? folder : "/var/tmp";
}

std::shared_ptr<void> allocate_plain(std::size_t bytes) {
  std::shared_ptr<void> memory = allocate(bytes);
  Pages::all().count_plain(bytes);
  void* const data = memory.get();
  return {data, [memory = std::move(memory), bytes](void*) mutable {
            memory.reset();
            Pages::all().forget_plain(bytes);
          }};
}

// Returns `memory` as an owner whose whole pages are let go from time to time.
std::shared_ptr<void> watched(std::shared_ptr<void> owner, void* memory, std::size_t bytes) {
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(memory);
  const std::size_t before = (page - begin % page) % page;
  if (bytes < before + page) return owner;
  char* const first = static_cast<char*>(memory) + before;
  Pages::all().add_file(first, (bytes - before) / page * page);
  return {memory, [owner = std::move(owner), first](void*) mutable {
            Pages::all().remove_file(first);
            owner.reset();
          }};
}

}  // namespace

void set_paged_budget(std::uint64_t bytes) {
  Pages::all().set_budget(bytes);
}

std::shared_ptr<void> allocate_paged(std::size_t bytes) {
  if (bytes < kLeast) return allocate(bytes);
  if (Pages::all().fits(bytes)) return allocate_plain(bytes);
  const std::filesystem::path folder = folder_of_files();
  if (std::shared_ptr<void> memory = map_nameless_file(folder, bytes)) {
    void* const data = memory.get();
    return watched(std::move(memory), data, bytes);
  }
  const int error = errno;
  if (!Pages::all().is_set()) return allocate_plain(bytes);
  throw input_error(folder.string(), 0,
                    "no room for " + std::to_string(bytes >> 20) +
                        " MiB of pictures beyond the texture cache: " + std::strerror(error),
                    "set TMPDIR to a folder with more, or make pictures smaller (--texture-memory)");
}

std::shared_ptr<void> page_mapped(std::shared_ptr<void> owner, void* memory, std::size_t bytes) {
  if (bytes < kLeast || Pages::all().fits(bytes)) return owner;
  return watched(std::move(owner), memory, bytes);
}

PagedBytes paged_bytes() {
  return Pages::all().bytes();
}

}  // namespace kdray
