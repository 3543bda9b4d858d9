#include "apps/cli/render_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "apps/cli/help.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "base/error.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

constexpr int kPictureSideMax = 65536;
// 16384 x 16384; memory.h refuses what this machine can't hold.
constexpr long long kPicturePixelsMax = 1ll << 28;

// In the order of the enumerations' values.
constexpr std::array<std::string_view, 3> kModes = {"auto", "pdprt", "odprt"};
constexpr std::array<std::string_view, 3> kDivisions = {"bag", "contiguous", "interleaved"};
constexpr std::array<std::string_view, 3> kBalances = {"sah", "pilot", "dynamic"};
constexpr std::array<std::string_view, 2> kGrids = {"centers", "corners"};
constexpr std::array<std::string_view, 2> kLooks = {"plain", "studio"};
// From above and below nearly: what is up must not be ahead.
constexpr std::array<std::string_view, 7> kSideNames = {"front", "back",   "left", "right",
                                                        "top",   "bottom", "iso"};
constexpr std::array<View::Vector, 7> kSides = {
    {{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {1, 0, 0}, {0, 1, 1e-3}, {0, -1, 1e-3}, {1, 1, 1}}};

}  // namespace

void add_picture_options(CLI::App& app, RenderOptions& o) {
  add_size(app,
           "Pixels across and down, or across alone (default, and what is left out: as the scene or its "
           "camera has it, or 1024x1024)",
           kPictureSideMax, kPicturePixelsMax, o.width, o.height, OneSide::by_aspect);
  add_int(app, "--depth", "Deepest ray; the eye ray is 1 (default: the scene's, or 5)", 1, 64, o.depth);
  add_real(app, "--min-weight", "W",
           "Rays of less weight are not traced (default: what can't change an 8-bit picture); 0: trace all",
           0, 1, o.min_weight);
  add_text(app, "--samples", "N|adaptive[:TARGET]",
           "Rays per pixel, stratified, up to 65536 (default: the scene's, or 1); or as many where they are "
           "needed as an RMSE of TARGET takes (default 0.0075)",
           [&o](const std::string& text) {
             const Samples samples = parse_samples("--samples", text);
             o.samples = samples.number, o.adaptive_target = samples.target;
           });
  add_choice(
      app, "--grid",
      "centers: rays through the pixels' centers; corners: the outermost rays go through the picture's "
      "corners, "
      "as the counts published for the SPD scenes are made",
      kGrids, o.grid);
  static constexpr std::array kOptions = {"--size", "--depth", "--min-weight", "--samples", "--grid"};
  put_into_group(app, "Picture", kOptions);
}

void add_crop_option(CLI::App& app, RenderOptions& o) {
  add_text(app, "--crop", "WxH+X+Y",
           "Render just this part of the picture, X and Y pixels from its top left: with the pixels that the "
           "whole one has there, but for adaptive sampling",
           [&o](const std::string& text) { o.crop = parse_crop("--crop", text); })
      ->group("Picture");
}

void show_most_used_first(CLI::App& app) {
  static constexpr std::array kMostUsed = {"--output", "--size", "--samples", "--look",       "--from",
                                           "--at",     "--up",   "--depth",   "--background", "--device"};
  put_into_group(app, kMostUsedGroup, kMostUsed);
}

void add_division_options(CLI::App& app, RenderOptions& o) {
  const std::string group = "Division";
  add_choice(app, "--mode", "What queues divide among them: pdprt the pixels, odprt the scene; auto chooses",
             kModes, o.mode)
      ->group(group);
  add_choice(app, "--division", "How pdprt's queues come by tiles (default: bag)", kDivisions, o.division)
      ->group(group);
  add_choice(app, "--balance", "What odprt's subtrees are dealt out by (default: pilot)", kBalances,
             o.balance)
      ->group(group);
  add_text(app, "--tile", "WxH", "Size of the tiles the picture is divided into (default: chosen)",
           [&o](const std::string& text) {
             const Size size = parse_size("--tile", text, kPictureSideMax, kPicturePixelsMax);
             o.tile_width = size.width, o.tile_height = size.height;
           })
      ->group(group);
  add_int(app, "--ray-buffer", "Rays in a buffer between two of odprt's queues, per slice (default: chosen)",
          1, 1 << 20, o.ray_buffer)
      ->group(group);
  add_text(app, "--device-memory", "BYTES",
           "The most that a device may hold, as in 500M: odprt's subtrees come and go",
           [&o](const std::string& text) { o.device_memory = parse_bytes("--device-memory", text); })
      ->group(group);
}

namespace {

View::Vector parse_vector(std::string_view option, std::string_view text) {
  const std::vector<double> numbers = parse_numbers(text);
  if (numbers.size() != 3) throw usage_error(option, text, "X,Y,Z");
  return {numbers[0], numbers[1], numbers[2]};
}

// "z", "-x", or a direction in numbers.
View::Vector parse_up(std::string_view option, std::string_view text) {
  static constexpr std::string_view kAxes = "xyz";
  View::Vector up = {};
  const bool down = text.starts_with('-');
  const std::string_view axis = text.substr(down ? 1 : 0);
  if (axis.size() == 1 && kAxes.find(axis) != std::string_view::npos) {
    up[kAxes.find(axis)] = down ? -1 : 1;
    return up;
  }
  const std::vector<double> numbers = parse_numbers(text);
  const auto is_zero = [](double x) { return x == 0; };
  if (numbers.size() != 3 || std::ranges::all_of(numbers, is_zero))
    throw usage_error(option, text, "x, y, z, -x, -y, -z, or X,Y,Z, not all 0");
  std::ranges::copy(numbers, up.begin());
  return up;
}

}  // namespace

void add_view_options(CLI::App& app, ViewOptions& options) {
  const std::string group = "View";
  const auto add = [&app, &options, &group](const std::string& name, const std::string& shape,
                                            const std::string& help, auto take) {
    return add_text(app, name, shape, help,
                    [name, take, &options](const std::string& text) {
                      options.any = true;
                      take(name, text);
                    })
        ->group(group);
  };
  View& view = options.view;
  add_text(app, "--look", "NAME",
           "studio: soft lights, a backdrop, a floor, a view that fits (default where the file has neither "
           "camera nor lights; asked for, instead of these); plain: two lights on black",
           [&options](const std::string& text) {
             options.look = static_cast<Look>(parse_choice("--look", text, kLooks));
           })
      ->group(group);
  CLI::Option* const from = add(
      "--from", "X,Y,Z", "Where the camera is (default: the scene's, or where all is in the picture)",
      [&view](const std::string& name, const std::string& text) { view.from = parse_vector(name, text); });
  add("--view", shape_of(kSideNames), "All of the scene from a side, in place of the file's camera",
      [&view](const std::string& name, const std::string& text) {
        view.side = kSides[parse_choice(name, text, kSideNames)];
      })
      ->excludes(from);
  add("--at", "X,Y,Z", "What it looks at",
      [&view](const std::string& name, const std::string& text) { view.at = parse_vector(name, text); });
  add("--up", "x|y|z|-x|-y|-z|X,Y,Z", "What is up: an axis (of scans often z), or a direction",
      [&view](const std::string& name, const std::string& text) { view.up = parse_up(name, text); });
  CLI::Option* const fov = add("--fov", "DEGREES", "Angle of view over the picture's full height",
                               [&view](const std::string& name, const std::string& text) {
                                 view.fov = parse_real(name, text, 1e-3, 179.9);
                               });
  add("--camera", "N", "Which of the cameras that the file has, from 0",
      [&view](const std::string& name, const std::string& text) {
        view.camera = parse_int(name, text, 0, 1 << 20);
      });
  add("--ortho", "[WIDTH]", "Parallel rays; the picture is WIDTH wide (default: as wide as the scene needs)",
      [&view](const std::string& name, const std::string& text) {
        view.ortho_width = text.empty() ? 0 : parse_real(name, text, 1e-30, 1e30);
      })
      ->expected(0, 1)
      ->excludes(fov);
  add("--aperture", "D", "A thin lens of this diameter: what is not in focus is blurred (0: a pinhole)",
      [&view](const std::string& name, const std::string& text) {
        view.aperture = parse_real(name, text, 0, 1e30);
      });
  add("--focus", "DISTANCE", "How far off, along the view, what is in focus is (default: as far as --at)",
      [&view](const std::string& name, const std::string& text) {
        view.focus = parse_real(name, text, 1e-30, 1e30);
      });
  add("--headlight", "S", "One more light at the camera, of strength S (as in 0.5)",
      [&view](const std::string& name, const std::string& text) {
        view.headlight = parse_real(name, text, 0, 1000);
      });
  add("--background", "COLOR|transparent",
      "A name of CSS, #rgb, #rrggbb, or R,G,B (linear); transparent: the picture gets alpha",
      [&options](const std::string& name, const std::string& text) {
        if (text == "transparent")
          options.transparent = true;
        else
          options.view.background = parse_color(name, text, "transparent, ");
      });
}

bool asks_for_studio(const ViewOptions& options) {
  return options.look == Look::studio;
}

void check_view_of(const ViewOptions& options, const scene::Scene& scene) {
  const bool of_file = !asks_for_studio(options) || options.view.camera;
  if (options.any && of_file) check_view(scene, options.view);
}

PreparedScene in_look(const PreparedScene& scene, const ViewOptions& options) {
  return options.look.value_or(Look::studio) == Look::studio ? scene.in_studio(asks_for_studio(options))
                                                             : scene;
}

void tell_of_view(const PreparedScene& scene, const ViewOptions& options) {
  const scene::Scene& settings = scene.settings();
  const View& view = options.view;
  if (!settings.framing.camera && settings.cameras.size() > 1 && !view.camera && !view.from && !view.side)
    say(fmt::format("using the file's camera 0 of {} (--camera N)", settings.cameras.size()));
  if (!settings.framing.studio || view.up || view.from) return;
  if (settings.framing.studio->up.z == 1) say("it stands on z, so that is up; else --up y");
  if (settings.framing.studio->perhaps_on_side) say("lies on its side? --up z");
}

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
  if (turntable > 0 && (!camera_path.empty() || fps))
    refuse("--turntable turns a model that stands still; leave --camera-path and --fps out");
  if (turntable > 0 && frames && frames->last >= turntable)
    refuse(fmt::format("--turntable {0} has the frames 0 to {1}; --frames is for some of these", turntable,
                       turntable - 1));
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
  add_int(app, "--turntable", "Render N frames once around the model, and say how to make a film of them", 1,
          kMostFrames, choice.turntable)
      ->group("Sequence");
  add_text(app, "--fps", "N", "Play a glTF file's animation: frame F is its second F/N, after --time",
           [&choice](const std::string& text) { choice.fps = parse_real("--fps", text, 1e-6, 1e6); })
      ->group("Sequence");
}

}  // namespace kdray::cli
