// What    Files and folders that must not outlive the process: known in one place, so that whatever ends it
//         can remove them. What owns one removes it on every other way out.
// Threads Any. Once remove_temporaries() has begun, whoever makes or removes one waits for the end of the
//         process.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace kdray {

class Temporary {
 public:
  // Of a name that nothing has yet: to be made after this, so that there is no moment at which it is not
  // known.
  explicit Temporary(std::filesystem::path path);
  // Removes it, a folder with all that is in it; but not in a process that was forked off since.
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // It has another name now, or is somebody else's.
  void forget();

 private:
  std::filesystem::path path_;
  pid_t process_;
};

// Removes all that this process has made. For the end of the process only: see Threads.
void remove_temporaries();

}  // namespace kdray
