#include "apps/cli/checkpoint_options.h"

#include <fmt/format.h>

#include "apps/cli/options.h"
#include "apps/cli/parse.h"
#include "base/error.h"

namespace kdray::cli {

namespace {

constexpr int kMostFrames = 999999;

void add_folder(CLI::App& app, const std::string& option, const std::string& help, std::string& folder) {
  add_text(app, option, "DIR", help, [option, &folder](const std::string& text) {
    if (text.empty()) throw usage_error(option, text, "a folder");
    folder = text;
  })->group("Checkpoint");
}

void add_seconds(CLI::App& app, const std::string& option, const std::string& help, double lo,
                 std::optional<double>& seconds) {
  add_text(app, option, "SECONDS", help, [option, lo, &seconds](const std::string& text) {
    seconds = parse_real(option, text, lo, 1e6);
  })->group("Checkpoint");
}

FrameRange parse_frames(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos)
    throw usage_error("--frames", text, "A..B, the numbers of the first and the last frame");
  const int first = parse_int("--frames", text.substr(0, dots), 0, kMostFrames);
  return {first, parse_int("--frames", text.substr(dots + 2), first, kMostFrames)};
}

}  // namespace

void CheckpointChoice::check() const {
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::usage, what); };
  if (!share.empty() && !checkpoint.empty())
    refuse("--share keeps a checkpoint as --checkpoint does; give one of them");
  if (resume && checkpoint.empty())
    refuse(share.empty() ? "--resume goes on from a checkpoint; say from which with --checkpoint DIR"
                         : "--share always goes on from what is there; leave --resume out");
  if (every_seconds && folder().empty())
    refuse("--checkpoint-every is about a checkpoint; add --checkpoint DIR or --share DIR");
  if (lease_seconds && share.empty()) refuse("--lease is about a shared checkpoint; add --share DIR");
  if (restarts > 0 && folder().empty())
    refuse("--restarts goes on from a checkpoint; add --checkpoint DIR or --share DIR");
  if (!camera_path.empty() && !frames)
    refuse("--camera-path is for the frames of a sequence; add --frames A..B");
  if (fps && !frames)
    refuse("--fps is for the frames of a sequence; add --frames A..B, or say --time SECONDS");
}

std::optional<LedgerOptions> CheckpointChoice::options(const std::filesystem::path& in) const {
  if (folder().empty()) return std::nullopt;
  LedgerOptions options;
  options.folder = in.empty() ? std::filesystem::path(folder()) : in;
  options.resume = resume;
  options.share = !share.empty();
  options.every_seconds = every_seconds.value_or(options.every_seconds);
  options.lease_seconds = lease_seconds.value_or(options.lease_seconds);
  return options;
}

void add_checkpoint_options(CLI::App& app, CheckpointChoice& choice) {
  add_folder(app, "--checkpoint", "Keep finished tiles in this folder, for a run that ends before its time",
             choice.checkpoint);
  app.add_flag("--resume", choice.resume, "Go on from the tiles that are in --checkpoint's folder, if any")
      ->group("Checkpoint");
  add_seconds(app, "--checkpoint-every", "How often they are written (default 10)", 0.01,
              choice.every_seconds);
  add_folder(app, "--share",
             "Make the picture together with all other processes that are given this folder, on any machine",
             choice.share);
  add_seconds(app, "--lease", "A process that isn't heard of for so long has lost its tiles (default 5)", 0.1,
              choice.lease_seconds);
  add_int(app, "--restarts", "How often a run that a signal has ended is begun again, from its checkpoint", 0,
          1000000, choice.restarts)
      ->group("Checkpoint");
  add_text(app, "--frames", "A..B", "Render these frames of a sequence, to numbered pictures",
           [&choice](const std::string& text) { choice.frames = parse_frames(text); })
      ->group("Sequence");
  add_path(app, "--camera-path", "JSON with cameras at some frames, between which the camera moves",
           choice.camera_path)
      ->group("Sequence");
  add_text(app, "--fps", "N", "Play a glTF file's animation: frame F is its second F/N, after --time",
           [&choice](const std::string& text) { choice.fps = parse_real("--fps", text, 1e-6, 1e6); })
      ->group("Sequence");
}

}  // namespace kdray::cli
