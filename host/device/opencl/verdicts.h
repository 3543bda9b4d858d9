// What    Verdicts on devices and drivers, kept between runs beside the built programs: what passed is not
//         tried again, and what has failed is not run into again.
// Shape   A verdict lies under a key, which tells all that has a say in it; another driver has another key.
//         The process that reached it always knows it, others where there is a folder.
// Errors  None: what is damaged counts as none, and a folder that can't be written is left.
// Threads Any, and several processes at once.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/hash.h"

namespace kdray::device {

struct Verdict {
  bool passed = false;
  std::string text;  // what is wrong, in words that follow a name: "crashes (SIGSEGV) in the self-test"
  bool operator==(const Verdict&) const = default;
};

class Verdicts {
 public:
  // With an empty folder there are only this process' own verdicts. Without `keeps` the folder is only read.
  explicit Verdicts(std::filesystem::path folder = {}, bool keeps = true)
      : folder_(std::move(folder)), keeps_(keeps && !folder_.empty()) {}

  std::optional<Verdict> find(const Hash& key) const;
  void note(const Hash& key, const Verdict& verdict) const;

  bool keeps() const { return keeps_; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  bool keeps_;
};

// A mark in the folder, as long as it lives: this process is about to do what may end it, or hold it up for
// ever. It stays behind when the process ends in any other way than by leaving the mark's scope.
class Mark {
 public:
  // Makes none where nothing is kept, or where another process has one.
  Mark(const Verdicts& verdicts, const Hash& key);
  ~Mark();
  Mark(const Mark&) = delete;
  Mark& operator=(const Mark&) = delete;

  // Returns whether there is a mark of a process that has ended.
  static bool is_left(const Verdicts& verdicts, const Hash& key);
  // Removes such a mark.
  static void forget(const Verdicts& verdicts, const Hash& key);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace kdray::device
