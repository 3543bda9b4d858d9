// What    A scene that pages show: where it comes from, and, once it is loaded, its renderer, what answers
//         picks, the cells of its tree, and what tells when one of the files that it was made of has changed.
// Shape   FileWatcher compares size, time of change and inode. A file that is still being written differs at
//         each check, so a change counts when two checks after it agree.
// Units   Cells are boxes in the scene's own units.
// Threads One thread calls render(), one calls pick(); any may call scene().
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "accel/prepare/prepared.h"
#include "apps/view/pick.h"
#include "apps/view/view_request.h"
#include "base/box.h"
#include "kdray/kdray.h"

namespace kdray::view {

struct LoadedScene {
  PreparedScene scene;                       // in the plain look
  std::vector<GeometryName> geometries;      // empty: all of it is geometry 0
  std::optional<PreparedScene> studio = {};  // where it has been made already
};

// A scene that the user has named; pages refer to it by its number in the list of them.
struct SceneSource {
  std::string name;
  std::string file;  // for the command line; empty: there is none that renders it
  // Throws kdray::Error. Also called again, when a file has changed or is to be read in another way.
  std::function<LoadedScene(const LoadOptions&)> open;
};

class SceneRenderer {
 public:
  SceneRenderer(LoadedScene loaded, const Settings& settings);

  const Settings& settings() const { return settings_; }
  // Returns it in the look of the command line, or in another one.
  const PreparedScene& scene() const { return scene({settings_.look, settings_.studio_instead}); }
  const PreparedScene& scene(const ShownLook& shown) const;
  // Returns all files that were read to make it, and those that were not found.
  std::vector<std::filesystem::path> files() const;
  // Returns the camera of the scene, or of the command line.
  Camera camera(int width, int height) const;

  // Renders what the page asks for, with options for a picture of any size.
  Picture render(const ViewRequest& request, const RenderOptions& options);
  const Statistics& statistics() const { return renderer_->statistics(); }

  std::optional<Picked> pick(const ViewRequest& request, double x, double y);

 private:
  void make_ready(const ViewRequest& request);

  LoadedScene loaded_;
  Settings settings_;
  struct Studio {
    std::once_flag made;
    std::optional<PreparedScene> scene;
  };
  // Of the command line, and in place of the file's own camera and lights: made when first asked for.
  mutable Studio studio_, instead_;
  std::optional<Renderer> renderer_;
  int queues_ = 0;  // of the renderer
  std::optional<Picker> picker_;
};

inline constexpr std::size_t kMostCells = 4096;

// Returns the cells of the kd-tree to a depth; leaves above it are cells, too. There are at most kMostCells,
// from a smaller depth if need be, and none for a scene without a binary form.
std::vector<DBox> cells_of(const prepare::Prepared& scene, int depth);

class FileWatcher {
 public:
  FileWatcher() = default;
  explicit FileWatcher(std::vector<std::filesystem::path> files);

  // Returns true once for each change.
  bool changed();

 private:
  std::string state() const;

  std::vector<std::filesystem::path> files_;
  std::string known_, last_;  // of all files
};

// What a page is shown of a picture: the colours, or the channel that was asked for. As JPEG, quick and
// small while something moves and nearly without loss at rest; as PNG like the file that `kdray render`
// writes. Errors: kdray::Error, ErrorCode::internal.
std::string as_jpeg(const Picture& picture, const RenderOptions& options, bool at_rest);

// Returns the bytes of the file that `kdray render` would write.
std::string as_png(const Picture& picture, const RenderOptions& options);

}  // namespace kdray::view
