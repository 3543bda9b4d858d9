// What    Tells when one of the files that a scene was made of has changed.
// Shape   Compares size, time of change and inode. A file that is still being written differs at each check,
//         so a change counts when two checks after it agree.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kdray::view {

class FileWatcher {
 public:
  FileWatcher() = default;
  explicit FileWatcher(std::vector<std::filesystem::path> files);

  // True once for each change.
  bool changed();

 private:
  std::string state() const;

  std::vector<std::filesystem::path> files_;
  std::string known_, last_;  // of all files
};

}  // namespace kdray::view
