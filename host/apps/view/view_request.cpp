#include "apps/view/view_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace kdray::view {

namespace {

void apply_samples(const ViewRequest& request, RenderOptions& options) {
  if (request.samples == Samples::as_given) return;
  options.adaptive_target = request.samples == Samples::adaptive ? kDefaultAdaptiveTarget : 0;
  options.samples = request.samples == Samples::number ? request.n_samples : 0;
}

// A channel is made of one ray through each pixel's centre, whatever the picture is made of; but not the
// counts of samples and the queues, which are about the picture's own rays.
void apply_channel(const ViewRequest& request, RenderOptions& options) {
  if (request.channel.empty()) return;
  options.channels = {request.channel};
  if (request.channel == "samples" || request.channel == "queue") return;
  options.depth = 1;
  options.samples = 1;
  options.adaptive_target = 0;
}

}  // namespace

View view_of(const ViewRequest& request, const Settings& settings) {
  View view = settings.view;
  view.from = request.camera.from;
  view.at = request.camera.at;
  view.up = request.camera.up;
  view.side.reset();
  view.fov.reset();
  view.ortho_width.reset();
  if (request.camera.ortho_width > 0)
    view.ortho_width = request.camera.ortho_width;
  else
    view.fov = request.camera.fov;
  view.headlight = request.headlight;
  if (request.background) view.background = request.background;
  return view;
}

RenderOptions render_of(const ViewRequest& request, const Settings& settings) {
  RenderOptions options = settings.render;
  options.width = request.width;
  options.height = request.height;
  if (request.depth > 0) options.depth = request.depth;
  if (request.min_weight >= 0) options.min_weight = request.min_weight;
  if (request.mode != Mode::automatic) options.mode = request.mode;
  if (request.traversal != Traversal::automatic) options.traversal = request.traversal;
  apply_samples(request, options);
  apply_channel(request, options);
  return options;
}

int queues_of(const ViewRequest& request, const Settings& settings) {
  return request.queues > 0 ? request.queues : settings.device.queues;
}

ShownLook look_of(const ViewRequest& request, const Settings& settings) {
  if (request.look) return {*request.look, true};
  return {settings.look, settings.studio_instead};
}

namespace {

// Quotes the text for a shell.
std::string quoted(const std::string& text) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string("/._-+,:@%=").find(char(c)) < 99;
  };
  if (!text.empty() && text[0] != '-' && std::ranges::all_of(text, is_plain)) return text;
  std::string result = text.starts_with('-') ? "'./" : "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string numbers(const View::Vector& v) {
  return fmt::format("{},{},{}", v[0], v[1], v[2]);
}

std::string view_options(const View& view) {
  std::string text =
      fmt::format(" --from={} --at={} --up={}", numbers(*view.from), numbers(*view.at), numbers(*view.up));
  if (view.camera) text += fmt::format(" --camera {}", *view.camera);
  if (view.fov) text += fmt::format(" --fov {}", *view.fov);
  if (view.ortho_width) text += fmt::format(" --ortho {}", *view.ortho_width);
  if (view.aperture) text += fmt::format(" --aperture {}", *view.aperture);
  if (view.focus) text += fmt::format(" --focus {}", *view.focus);
  if (view.headlight > 0) text += fmt::format(" --headlight {}", view.headlight);
  if (const auto& b = view.background)
    text += fmt::format(" --background {},{},{}", (*b)[0], (*b)[1], (*b)[2]);
  return text;
}

std::string picture_options(const RenderOptions& o) {
  std::string text = fmt::format(" --size {}x{}", o.width, o.height);
  if (o.depth > 0) text += fmt::format(" --depth {}", o.depth);
  if (o.min_weight >= 0) text += fmt::format(" --min-weight {}", o.min_weight);
  if (o.adaptive_target == kDefaultAdaptiveTarget)
    text += " --samples adaptive";
  else if (o.adaptive_target > 0)
    text += fmt::format(" --samples adaptive:{}", o.adaptive_target);
  else if (o.samples > 0)
    text += fmt::format(" --samples {}", o.samples);
  if (o.grid == PixelGrid::corners) text += " --grid corners";
  if (o.precision == Precision::float64) text += " --precision double";
  return text;
}

std::string division_options(const RenderOptions& o, int queues) {
  std::string text;
  if (queues > 1) text += fmt::format(" --queues {}", queues);
  if (o.mode != Mode::automatic) text += fmt::format(" --mode {}", kModes[static_cast<std::size_t>(o.mode)]);
  if (o.traversal != Traversal::automatic)
    text += fmt::format(" --traversal {}", kWalks[static_cast<std::size_t>(o.traversal)]);
  for (const std::string& channel : o.channels) text += " --aov " + channel;
  return text;
}

}  // namespace

// Numbers are as short as they can be and still be read back as the same bits. What can't change a bit
// (device, tree, cache) is left out; mode, walk and queues are there where the page has chosen some, for
// timing.
std::string command_for(const ViewRequest& request, const Settings& settings, const std::string& scene) {
  const RenderOptions options = render_of(request, settings);
  std::string text = "kdray render " + quoted(scene);
  if (settings.load.instances == Instances::flat) text += " --instances flat";
  if (settings.load.instances == Instances::kept) text += " --instances kept";
  if (settings.load.smooth_degrees) text += fmt::format(" --smooth {}", *settings.load.smooth_degrees);
  if (settings.load.time) text += fmt::format(" --time {}", *settings.load.time);
  if (!settings.load.animation.empty()) text += " --animation " + quoted(settings.load.animation);
  if (settings.load.texture_bytes > 0)
    text += fmt::format(" --texture-memory {}", settings.load.texture_bytes);
  if (!settings.load.asset_root.empty()) text += " --asset-root " + quoted(settings.load.asset_root.string());
  const ShownLook shown = look_of(request, settings);
  if (shown.look == kdray::Look::plain)
    text += " --look plain";
  else if (shown.instead)
    text += " --look studio";
  return text + view_options(view_of(request, settings)) + picture_options(options) +
         division_options(options, queues_of(request, settings));
}

}  // namespace kdray::view
