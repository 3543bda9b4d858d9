// What    A file that says where the camera is in the frames of a sequence: cameras at some frames, and a
//         curve through them (docs/cli.md has the form).
// Shape   { "kdray_camera_path": 1, "interpolation": "smooth", "keys": [{"frame": 0, "from": [x, y, z], "at":
//         ..., "up": ..., "fov": degrees}, ...] }
//         Before the first key and after the last the camera stands still.
// Why     Each frame's camera follows from the file and the frame's number alone, so that all processes that
//         render a sequence see the same.
// Errors  kdray::Error, ErrorCode::input: the file, the value's place in it, what is wrong.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "kdray/model.h"

namespace kdray::cli {

class CameraPath {
 public:
  explicit CameraPath(const std::filesystem::path& file);

  Camera at(int frame) const;

 private:
  static constexpr std::size_t kValues = 10;  // from, at, up, fov
  using Values = std::array<double, kValues>;
  struct Key {
    double frame;
    Values values;
  };

  double slope(std::size_t key, std::size_t value) const;

  std::string file_;
  std::vector<Key> keys_;
  bool smooth_ = true;
};

}  // namespace kdray::cli
