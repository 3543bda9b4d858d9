// What    The fuzzers' targets: each reads bytes as one of kdray's readers does. libFuzzer makes up the bytes
//         (libfuzzer.cpp, scripts/fuzz); the tests read those that are kept (corpus_test.cpp).
// Shape   A target is a file of this folder that has one KDRAY_FUZZ; tests/fuzz/corpus/NAME has its bytes.
// Errors  A reader either reads its input or refuses it by a kdray::Error of the expected code, in one line.
//         Whatever else it does ends the process: that is what is looked for.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kdray::fuzz {

struct Target {
  const char* name;
  bool (*read)(std::string_view bytes);  // false: the bytes are refused
};

// Returns the targets of this program.
std::vector<Target>& targets();

struct Registered {
  Registered(const char* name, bool (*read)(std::string_view bytes)) { targets().push_back({name, read}); }
};

// Ends the process with a message.
[[noreturn]] void fail(const std::string& what);

// Returns whether `read` has read its input; false where it has refused it as it should.
template <class Read>
bool is_read(const Read& read, ErrorCode refused = ErrorCode::input) {
  try {
    read();
    return true;
  } catch (const Error& e) {
    const std::string what = e.what();
    if (e.code() != refused) fail("refused with another code: " + what);
    if (what.empty() || what.find_first_of("\n\r") != std::string::npos)
      fail("refused in no line, or several: " + what);
    return false;
  }
}

// A file in memory, for readers that open theirs by name.
class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  void put(std::string_view bytes) const;
  const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

// Takes an input apart from its front; what isn't there is 0.
class Input {
 public:
  explicit Input(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  T take() {
    T value{};
    const std::string_view bytes = some(sizeof value);
    bytes.copy(reinterpret_cast<char*>(&value), bytes.size());
    return value;
  }
  std::string_view some(std::size_t n) {
    const std::string_view bytes = rest_.substr(0, n);
    rest_.remove_prefix(bytes.size());
    return bytes;
  }
  // Returns bytes whose number stands before them, in two bytes.
  std::string_view block() { return some(take<std::uint16_t>()); }
  std::string_view rest() const { return rest_; }
  bool is_at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

}  // namespace kdray::fuzz

#define KDRAY_FUZZ(name, bytes)                                               \
  static bool fuzz_##name(std::string_view bytes);                            \
  static const kdray::fuzz::Registered registered_##name(#name, fuzz_##name); \
  static bool fuzz_##name(std::string_view bytes)
