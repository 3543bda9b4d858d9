// What    The options of render on checkpoints and on sequences: --checkpoint --resume --checkpoint-every
//         --share --lease --restarts, --frames --camera-path --fps.
// Errors  kdray::Error, ErrorCode::usage: options that don't go together.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "kdray/options.h"

namespace kdray::cli {

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
  std::optional<double> fps = {};  // frames to a second of the scene's animation; none: it stands still

  void check() const;
  const std::string& folder() const { return share.empty() ? checkpoint : share; }
  // Of a frame whose checkpoint is in this folder, or in the one that was named.
  std::optional<LedgerOptions> options(const std::filesystem::path& in = {}) const;
};

void add_checkpoint_options(CLI::App& app, CheckpointChoice& choice);

}  // namespace kdray::cli
