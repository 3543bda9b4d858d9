// What    A scene that pages show: where it comes from, and, once it is loaded, its renderer and what answers
//         picks.
// Threads One thread calls render(), one calls pick(); any may call scene().
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/view/pick.h"
#include "apps/view/view_request.h"
#include "kdray/kdray.h"

namespace kdray::view {

struct LoadedScene {
  PreparedScene scene;
  std::vector<GeometryName> geometries;  // empty: all of it is geometry 0
};

// A scene that the user has named; pages refer to it by its number in the list of them.
struct SceneSource {
  std::string name;
  std::string file;                   // for the command line; empty: there is none that renders it
  std::function<LoadedScene()> open;  // throws kdray::Error; also called again, when a file has changed
};

class SceneRenderer {
 public:
  SceneRenderer(LoadedScene loaded, const Settings& settings);

  const PreparedScene& scene() const { return loaded_.scene; }
  // All that was read, or looked for in vain, to make it.
  std::vector<std::filesystem::path> files() const;
  // Where the scene, or the command line, has the camera.
  Camera camera(int width, int height) const;

  // As the page sees it, with options for a picture of any size.
  Picture render(const ViewRequest& request, const RenderOptions& options);
  const Statistics& statistics() const { return renderer_->statistics(); }

  std::optional<Picked> pick(const ViewRequest& request, double x, double y);

 private:
  void make_ready(const ViewRequest& request);

  LoadedScene loaded_;
  Settings settings_;
  std::optional<Renderer> renderer_;
  int queues_ = 0;  // of the renderer
  std::optional<Picker> picker_;
};

}  // namespace kdray::view
