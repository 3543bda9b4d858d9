// What    A scene that pages look at: where it comes from, and, once it is open, its renderer and what
//         answers picks.
// Threads One renders (render), one picks; scene() is for all.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/view/pick.h"
#include "apps/view/sight.h"
#include "kdray/kdray.h"

namespace kdray::view {

struct Opened {
  PreparedScene scene;
  std::vector<GeometryName> geometries;  // empty: all of it is geometry 0
};

// A scene that the user has named; pages know it by its number among these alone.
struct Source {
  std::string name;
  std::string file;              // for the command line; empty: there is none that renders it
  std::function<Opened()> open;  // throws kdray::Error; also called again, when a file has changed
};

class Stage {
 public:
  Stage(Opened opened, const Settings& settings);

  const PreparedScene& scene() const { return opened_.scene; }
  // All that was read, or looked for in vain, to make it.
  std::vector<std::filesystem::path> files() const;
  // Where the scene, or the command line, has the camera.
  Camera camera(int width, int height) const;

  // As the page sees it, with options for a picture of any size.
  Picture render(const Sight& sight, const RenderOptions& options);
  const Statistics& statistics() const { return renderer_->statistics(); }

  std::optional<Picked> pick(const Sight& sight, double x, double y);

 private:
  void make_ready(const Sight& sight);

  Opened opened_;
  Settings settings_;
  std::optional<Renderer> renderer_;
  int queues_ = 0;  // of the renderer
  std::optional<Picker> picker_;
};

}  // namespace kdray::view
