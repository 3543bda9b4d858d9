#include "apps/view/view_request.h"

namespace kdray::view {

namespace {

void apply_samples(const ViewRequest& request, RenderOptions& options) {
  if (request.samples == Samples::as_given) return;
  options.adaptive_target = request.samples == Samples::adaptive ? kDefaultAdaptiveTarget : 0;
  options.samples = request.samples == Samples::number ? request.n_samples : 0;
}

// A channel is of one ray through each pixel's centre, whatever the picture beside it is made of; all but the
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
  view.fov.reset();
  view.ortho_width.reset();
  if (request.camera.ortho_width > 0)
    view.ortho_width = request.camera.ortho_width;
  else
    view.fov = request.camera.fov;
  view.headlight = request.headlight;
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

}  // namespace kdray::view
