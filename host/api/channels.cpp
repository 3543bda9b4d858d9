#include "api/channels.h"

#include <algorithm>
#include <string>

#include "api/owners.h"

#include "engine/wavefront/channels.h"

namespace kdray::api {

namespace {

film::Channel samples_channel(const Job& job, Drawn& drawn) {
  if (drawn.samples) return {"samples", std::move(drawn.samples->counts)};
  return {"samples", std::vector<float>(drawn.image.pixels.size(), static_cast<float>(job.frame.n_samples))};
}

}  // namespace

std::vector<film::Channel> channels_of(State& state, const Job& job, Drawn& drawn) {
  std::vector<std::string> traced = job.options.channels;
  const bool counted = std::erase(traced, "samples") > 0;
  const bool owned = std::erase(traced, "queue") > 0;
  // What was hit tells whose subtree it lies in.
  const bool by_depth = owned && drawn.owners.of_tiles.empty();
  const bool only_for_that = by_depth && std::ranges::find(traced, "depth") == traced.end();
  if (only_for_that) traced.insert(traced.begin(), "depth");
  std::vector<film::Channel> channels;
  if (!traced.empty()) {
    Device& device = state.devices.first();
    channels =
        wavefront::render_channels(device.context, device.buffers(), device.programs, job.frame,
                                   state.scene.geometry.space, job.features, job.options.precision, traced);
  }
  if (owned) {
    const auto depth = std::ranges::find(channels, "depth", &film::Channel::name);
    channels.push_back({"queue", by_depth ? queues_by_subtrees(state, job.frame, drawn.owners, depth->values)
                                          : queues_by_tiles(job.frame, drawn.owners)});
    if (only_for_that) channels.erase(channels.begin());
  }
  if (counted) channels.push_back(samples_channel(job, drawn));
  return channels;
}

}  // namespace kdray::api
