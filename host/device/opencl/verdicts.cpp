#include "device/opencl/verdicts.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <map>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/cache_folder.h"
#include "base/error.h"
#include "device/opencl/program_cache.h"

namespace kdray::device {

namespace fs = std::filesystem;

namespace {

constexpr const char* kVerdictEnding = ".verdict";
constexpr const char* kMarkEnding = ".trying";
constexpr std::uint64_t kMostBytes = 1 << 18;  // some 1500 verdicts
constexpr std::string_view kPassed = "passed ", kFailed = "failed ";

using Place = std::pair<std::uint64_t, std::uint64_t>;

struct Known {
  std::mutex mutex;
  std::map<Place, Verdict> verdicts;
};

Known& known() {
  static Known* const all = new Known;
  return *all;
}

std::optional<Verdict> parsed(const std::string& entry) {
  for (const std::string_view word : {kPassed, kFailed})
    if (entry.starts_with(word)) return Verdict{word == kPassed, entry.substr(word.size())};
  return std::nullopt;
}

}  // namespace

std::optional<Verdict> Verdicts::find(const Hash& key) const {
  {
    const std::lock_guard lock(known().mutex);
    const auto found = known().verdicts.find({key.high, key.low});
    if (found != known().verdicts.end()) return found->second;
  }
  if (folder_.empty()) return std::nullopt;
  const std::optional<std::string> entry = read_entry(entry_file(folder_, key, kVerdictEnding), key);
  return entry ? parsed(*entry) : std::nullopt;
}

void Verdicts::note(const Hash& key, const Verdict& verdict) const {
  {
    const std::lock_guard lock(known().mutex);
    known().verdicts[{key.high, key.low}] = verdict;
  }
  if (!keeps_) return;
  try {
    std::error_code error;  // told by write_entry
    fs::create_directories(folder_, error);
    write_entry(entry_file(folder_, key, kVerdictEnding), key,
                std::string(verdict.passed ? kPassed : kFailed) + verdict.text);
    shrink_folder(folder_, kVerdictEnding, kMostBytes);
  } catch (const Error&) {  // it will be found out again
  }
}

// The lock goes with the process, however that ends.
Mark::Mark(const Verdicts& verdicts, const Hash& key) {
  if (!verdicts.keeps()) return;
  std::error_code error;
  fs::create_directories(verdicts.folder(), error);
  file_ = entry_file(verdicts.folder(), key, kMarkEnding);
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(descriptor_);
  descriptor_ = -1;
}

Mark::~Mark() {
  if (descriptor_ < 0) return;
  ::unlink(file_.c_str());
  ::close(descriptor_);
}

bool Mark::is_left(const Verdicts& verdicts, const Hash& key) {
  if (verdicts.folder().empty()) return false;
  const int mark = ::open(entry_file(verdicts.folder(), key, kMarkEnding).c_str(), O_RDONLY | O_CLOEXEC);
  if (mark < 0) return false;
  const bool free = ::flock(mark, LOCK_SH | LOCK_NB) == 0;
  ::close(mark);
  return free;
}

void Mark::forget(const Verdicts& verdicts, const Hash& key) {
  if (verdicts.keeps() && is_left(verdicts, key))
    ::unlink(entry_file(verdicts.folder(), key, kMarkEnding).c_str());
}

}  // namespace kdray::device
