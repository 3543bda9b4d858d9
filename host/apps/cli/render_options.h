// What    The options of render: what a picture is made of, where it is seen from and what is behind it, and
//         how its work is divided among queues, all of which view has as well; and checkpoints and sequences.
// Errors  kdray::Error, ErrorCode::usage: a value, or options that don't go together.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "kdray/kdray.h"

namespace kdray::cli {

// --size --depth --min-weight --samples --grid
void add_picture_options(CLI::App& app, RenderOptions& options);

// --crop
void add_crop_option(CLI::App& app, RenderOptions& options);

// What most people need of render and view comes first in help. Called when all options have been added.
void show_most_used_first(CLI::App& app);

// --mode --division --balance --tile --ray-buffer --device-memory
void add_division_options(CLI::App& app, RenderOptions& options);

struct ViewOptions {
  View view;
  std::optional<Look> look = {};  // none: a studio, where that can be
  bool transparent = false;       // --background transparent
  bool any = false;               // whether one was given
};

// --look --from --at --up --fov --camera --ortho --aperture --focus --headlight --background
void add_view_options(CLI::App& app, ViewOptions& options);

// Checks the view before a tree is built for nothing. A studio that is asked for has a camera of its own.
void check_view_of(const ViewOptions& options, const scene::Scene& scene);

// Returns whether a studio is asked for, which stands in for a file's camera and lights as well.
bool asks_for_studio(const ViewOptions& options);

// Returns the scene in the look that is asked for.
PreparedScene in_look(const PreparedScene& scene, const ViewOptions& options);

// Says where the view comes from, where that was neither asked for nor plain to see: from the file's camera,
// from a guess of what is up.
void tell_of_view(const PreparedScene& scene, const ViewOptions& options);

struct FrameRange {
  int first = 0, last = 0;
};

struct CheckpointChoice {
  std::string checkpoint, share;  // the folder; both empty: no checkpoint
  bool resume = false;
  std::optional<double> every_seconds = {}, lease_seconds = {};
  int restarts = 0;
  std::optional<FrameRange> frames = {};
  std::string camera_path;         // empty: none
  int turntable = 0;               // frames of a turn; 0: none
  std::optional<double> fps = {};  // frames to a second of the scene's animation; none: it stands still

  void check() const;
  const std::string& folder() const { return share.empty() ? checkpoint : share; }
  // Returns the options of a frame whose checkpoint is in this folder, or, without one, in the folder of the
  // options.
  std::optional<LedgerOptions> options(const std::filesystem::path& in = {}) const;
};

// --checkpoint --resume --checkpoint-every --share --lease --restarts, --frames --camera-path --turntable
// --fps
void add_checkpoint_options(CLI::App& app, CheckpointChoice& choice);

}  // namespace kdray::cli
