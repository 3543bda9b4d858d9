// What    What render is asked for, and the way from there to a picture in its file: for one frame, or for
//         several that have a scene in common.
// Shape   With ranks, all of them make a frame, and rank 0 writes its files.
//         Everything that can be refused is refused before the scene is read; the picture is written whole or
//         not at all, the statistics after it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "api/hooks.h"
#include "apps/cli/camera_path.h"
#include "apps/cli/open_scene.h"
#include "apps/cli/options.h"
#include "apps/cli/render_options.h"
#include "apps/cli/run_files.h"
#include "apps/cli/scene_input.h"
#include "base/box.h"
#include "base/timer.h"
#include "io/image/picture_file.h"
#include "kdray/kdray.h"

namespace kdray::cli {

// --hold: what each rank has of a scene that ODPRT divides.
enum class Holding { automatic, whole, shares };

struct RenderArgs {
  SceneInput scene;
  std::string output, stats, timeline;
  bool quiet = false, verbose = false;
  bool gamma_given = false, exposure_given = false, bits_given = false;
  CacheChoice cache;
  TreeOptions tree;
  DeviceOptions device;
  api::Hooks hooks;
  RenderOptions render;  // with the checkpoint that the frame has
  ViewOptions view;
  image::WriteOptions write;
  CheckpointChoice checkpoint;
  Holding holding = Holding::automatic;
};

// A scene on its device, ready for frames.
class FrameMaker {
 public:
  // Returns a film's first frame as it is seen; called where the scene lacks what was made up for that.
  using First = std::function<const scene::Scene&()>;

  // `o` has the arguments of the first frame that it makes. `first`: none where that is the film's, or no
  // film has several scenes.
  explicit FrameMaker(RenderArgs& o, const First& first = {});

  const PreparedScene& seen() const { return *seen_; }
  // What is worth showing of its scene.
  const DBox& box() const;

  // What a camera that goes along a path may keep of the scene's: parallel rays, hither and lens.
  Camera own_camera() const;

  // Has the frames from the next one on seen after so many turns about the scene (Turntable).
  void turn(const RenderArgs& o, double turns);

  // Renders a frame of the scene, and writes its files.
  void make(RenderArgs& o);

  bool has_odd_side() const { return has_odd_side_; }  // the last picture

 private:
  Picture render(const RenderArgs& o);

  Timer total_;  // since the start, or the last frame's end
  RunFiles files_;
  std::optional<OpenedScene> scene_;
  std::optional<PreparedScene> shown_, seen_;  // in its look; and by the frame's view
  std::optional<Renderer> renderer_;
  std::optional<Turntable> turntable_;
  bool is_first_ = true, has_odd_side_ = false;
  bool is_further_ = false;  // it makes further frames of a film of several scenes
};

}  // namespace kdray::cli
