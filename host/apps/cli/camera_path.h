// What    A file that says where the camera is in the frames of a sequence: cameras at some frames, and a
//         curve through them (docs/cli.md has the form).
// Shape   { "kdray_camera_path": 1, "interpolation": "smooth", "keys": [{"frame": 0, "from": [x, y, z], "at":
//         ..., "up": ..., "fov": degrees}, ...] }
//         Keys may have "ortho", "hither", "aperture" and "focus", each all or none: else those are the
//         scene's. Before the first key and after the last the camera stands still.
// Why     Each frame's camera follows from the file and the frame's number alone, so that all processes that
//         render a sequence see the same.
// Errors  kdray::Error, ErrorCode::input: the file, the value's place in it, what is wrong.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "kdray/kdray.h"
#include "kdray/model.h"
#include "scene/model/scene.h"

namespace kdray::cli {

class CameraPath {
 public:
  explicit CameraPath(const std::filesystem::path& file);

  // `own` is the scene's, which has what no key has.
  Camera at(int frame, const Camera& own = {}) const;

 private:
  static constexpr std::size_t kPlaced = 10, kOwn = 4, kValues = kPlaced + kOwn;  // from, at, up, fov; others
  using Values = std::array<double, kValues>;
  struct Key {
    double frame;
    Values values;
  };

  double slope(std::size_t key, std::size_t value) const;

  std::string file_;
  std::vector<Key> keys_;
  std::array<bool, kOwn> has_ = {};  // of the others
  bool has_fov_ = false;             // some key
  bool smooth_ = true;
};

// --turntable N: where the camera is in each of N frames, which go once around what it looks at. Where it
// was chosen for the scene, it is as far off as takes all of the scene into every frame; in a room it looks
// around.
class Turntable {
 public:
  // `seen` is the scene, without its primitives, as it is seen by `asked`; `aspect` is the picture's width
  // divided by its height.
  Turntable(const scene::Scene& seen, const View& asked, double aspect);

  // The view after so many turns about the axis that is up, counterclockwise as seen from above.
  View after(double turns) const;

 private:
  View asked_;
  scene::Camera camera_;
  bool looks_around_ = false;
};

}  // namespace kdray::cli
