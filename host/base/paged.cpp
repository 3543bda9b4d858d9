#include "base/paged.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/free_memory.h"
#include "base/memory.h"
#include "base/nameless_file.h"
#include "base/resident.h"

namespace kdray {

namespace {

constexpr std::size_t kLeast = std::size_t{1} << 20;  // smaller blocks are plain, and not counted
constexpr auto kPause = std::chrono::milliseconds(5);

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

  // Whether plain memory may have so much more.
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
  // Once this returns, nobody here touches that memory any more.
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

  // All mapped files together take a moment to ask for, and these alone much longer: they are looked at when
  // all have become enough more for them to have come near their share.
  void let_go_of_many() {
    const std::uint64_t share = budget() / 4, now = resident_of_files();
    if (now < seen_ + share / 8) {
      seen_ = std::min(seen_, now);
      return;
    }
    if (resident_of(files_) > share)
      for (const auto& [memory, bytes] : files_) ::madvise(memory, bytes, MADV_DONTNEED);
    seen_ = resident_of_files();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::uint64_t> budget_;
  bool is_set_ = false, watched_ = false;
  std::uint64_t plain_ = 0;
  std::map<void*, std::size_t> files_;
  std::uint64_t seen_ = 0;  // of all mapped files, when these were looked at
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

// The whole pages of it, which are let go from time to time.
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
