// What    Files and folders that must not outlive the process: known in one place, so that whatever ends it
//         can remove them. What owns one removes it on every other way out.
// Threads Any. Once remove_temporaries() has begun, a thread that makes or removes one waits for the end of
//         the process.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>

namespace kdray {

class Temporary {
 public:
  // `path` is a name that nothing has yet; the file is made after this, so that there is no moment at which
  // it is not known.
  explicit Temporary(std::filesystem::path path);
  // Removes the file, or the folder with all that is in it, but not in a process that was forked off since.
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Leaves the file alone from now on: it has another name, or another owner.
  void forget();

 private:
  std::filesystem::path path_;
  pid_t process_;
};

// Removes all that this process has made. Only for the end of the process: see Threads.
void remove_temporaries();

// Makes a folder for nobody but this user, in the system's folder for temporary files or in `where`, as
// "<prefix><process>-<random>"; null where it can't be made. Removes the folders of that prefix whose
// processes have ended: those that were killed have left them behind.
std::unique_ptr<Temporary> make_temporary_folder(const std::string& prefix);
std::unique_ptr<Temporary> make_temporary_folder(const std::string& prefix,
                                                 const std::filesystem::path& where);

}  // namespace kdray
