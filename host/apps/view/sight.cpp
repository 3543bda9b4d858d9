#include "apps/view/sight.h"

namespace kdray::view {

namespace {

void take_samples(const Sight& sight, RenderOptions& options) {
  if (sight.samples == Samples::as_given) return;
  options.adaptive_target = sight.samples == Samples::adaptive ? kDefaultAdaptiveTarget : 0;
  options.samples = sight.samples == Samples::number ? sight.n_samples : 0;
}

// A channel is of one ray through each pixel's centre, whatever the picture beside it is made of; all but the
// counts of samples and the queues, which are about the picture's own rays.
void take_channel(const Sight& sight, RenderOptions& options) {
  if (sight.channel.empty()) return;
  options.channels = {sight.channel};
  if (sight.channel == "samples" || sight.channel == "queue") return;
  options.depth = 1;
  options.samples = 1;
  options.adaptive_target = 0;
}

}  // namespace

View view_of(const Sight& sight, const Settings& settings) {
  View view = settings.view;
  view.from = sight.camera.from;
  view.at = sight.camera.at;
  view.up = sight.camera.up;
  view.fov.reset();
  view.ortho_width.reset();
  if (sight.camera.ortho_width > 0)
    view.ortho_width = sight.camera.ortho_width;
  else
    view.fov = sight.camera.fov;
  view.headlight = sight.headlight;
  return view;
}

RenderOptions render_of(const Sight& sight, const Settings& settings) {
  RenderOptions options = settings.render;
  options.width = sight.width;
  options.height = sight.height;
  if (sight.depth > 0) options.depth = sight.depth;
  if (sight.min_weight >= 0) options.min_weight = sight.min_weight;
  if (sight.mode != Mode::automatic) options.mode = sight.mode;
  if (sight.traversal != Traversal::automatic) options.traversal = sight.traversal;
  take_samples(sight, options);
  take_channel(sight, options);
  return options;
}

int queues_of(const Sight& sight, const Settings& settings) {
  return sight.queues > 0 ? sight.queues : settings.device.queues;
}

}  // namespace kdray::view
