#include "apps/cli/render_options.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "apps/cli/options.h"
#include "apps/cli/parse.h"

namespace kdray::cli {

namespace {

constexpr int kPictureSideMax = 65536;
// 16384 x 16384; memory.h refuses what this machine can't hold.
constexpr long long kPicturePixelsMax = 1ll << 28;

// Adds an option that takes one of an enumeration's names, in the order of its values.
template <class Choice, std::size_t kN>
void add_choice(CLI::App& app, const std::string& option, const std::string& help,
                const std::array<std::string_view, kN>& names, Choice& choice) {
  add_text(app, option, "NAME", help, [option, &names, &choice](const std::string& text) {
    parse_choice(option, text, names);
    choice = static_cast<Choice>(std::find(names.begin(), names.end(), text) - names.begin());
  })->group("Division");
}

}  // namespace

void add_picture_options(CLI::App& app, RenderOptions& o) {
  add_size(app, "Pixels across and down (default: the scene's or its camera's, or 1024x1024)",
           kPictureSideMax, kPicturePixelsMax, o.width, o.height);
  add_int(app, "--depth", "Deepest ray; the eye ray is 1 (default: the scene's, or 5)", 1, 64, o.depth);
  add_real(app, "--min-weight", "W",
           "Rays of less weight are not traced (default: what can't change an 8-bit picture); 0: trace all",
           0, 1, o.min_weight);
  add_text(app, "--samples", "N|adaptive[:TARGET]",
           "Rays per pixel, stratified (default: the scene's, or 1); or as many where they are needed as an "
           "RMSE of "
           "TARGET takes (default 0.0075)",
           [&o](const std::string& text) {
             const Samples samples = parse_samples("--samples", text);
             o.samples = samples.number, o.adaptive_target = samples.target;
           });
  static constexpr std::array<std::string_view, 2> kGrids = {"centers", "corners"};
  add_text(app, "--grid", "NAME",
           "centers: rays through the pixels' centers; corners: the outermost rays go through the picture's "
           "corners, "
           "as the counts published for the SPD scenes are made",
           [&o](const std::string& text) {
             const bool corners = parse_choice("--grid", text, kGrids) == "corners";
             o.grid = corners ? PixelGrid::corners : PixelGrid::centers;
           });
}

void add_division_options(CLI::App& app, RenderOptions& o) {
  static constexpr std::array<std::string_view, 3> kModes = {"auto", "pdprt", "odprt"};
  static constexpr std::array<std::string_view, 3> kDivisions = {"bag", "contiguous", "interleaved"};
  static constexpr std::array<std::string_view, 3> kBalances = {"sah", "pilot", "dynamic"};
  const std::string group = "Division";
  add_choice(app, "--mode", "What queues divide among them: pdprt the pixels, odprt the scene; auto chooses",
             kModes, o.mode);
  add_choice(app, "--division", "How pdprt's queues come by tiles: bag (default), contiguous, interleaved",
             kDivisions, o.division);
  add_choice(app, "--balance", "What odprt's subtrees are dealt out by: sah, pilot (default), dynamic",
             kBalances, o.balance);
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

}  // namespace kdray::cli
