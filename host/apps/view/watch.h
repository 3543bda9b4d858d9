// What    Tells when one of the files that a scene was made of has changed.
// Shape   Size, time of change and inode are looked at. A file that is still being written changes with each
//         look, so a change counts when two looks after it agree.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kdray::view {

class Watch {
 public:
  Watch() = default;
  explicit Watch(std::vector<std::filesystem::path> files);

  // Once for each change.
  bool changed();

 private:
  std::string look() const;

  std::vector<std::filesystem::path> files_;
  std::string known_, last_;  // of all files
};

}  // namespace kdray::view
