#include "api/channels.h"

#include <algorithm>
#include <string>

#include "api/owners.h"

#include "engine/wavefront/channels.h"

namespace kdray::api {

namespace {

image::Channel samples_channel(const Job& job, FrameResult& frame_result) {
  if (frame_result.samples) return {"samples", std::move(frame_result.samples->counts)};
  return {"samples",
          std::vector<float>(frame_result.image.pixels.size(), static_cast<float>(job.frame.n_samples))};
}

}  // namespace

std::vector<image::Channel> channels_of(State& state, const Job& job, FrameResult& frame_result) {
  std::vector<std::string> traced = job.options.channels;
  const bool counted = std::erase(traced, "samples") > 0;
  const bool owned = std::erase(traced, "queue") > 0;
  // What was hit tells whose subtree it lies in.
  const bool by_depth = owned && frame_result.owners.of_tiles.empty();
  const bool only_for_that = by_depth && std::ranges::find(traced, "depth") == traced.end();
  if (only_for_that) traced.insert(traced.begin(), "depth");
  std::vector<image::Channel> channels;
  if (!traced.empty()) {
    std::vector<wavefront::ChannelQueue> queues;
    for (Device& device : state.devices)
      for (const cl::CommandQueue& queue : device.context.queues())
        queues.push_back({device.context, device.buffers(), device.programs, queue});
    channels = wavefront::render_channels(queues, job.frame, state.scene.geometry.space, job.features,
                                          job.options.precision, traced);
  }
  if (owned) {
    const auto depth = std::ranges::find(channels, "depth", &image::Channel::name);
    channels.push_back(
        {"queue", by_depth ? queues_by_subtrees(state, job.frame, frame_result.owners, depth->values)
                           : queues_by_tiles(job.frame, frame_result.owners)});
    if (only_for_that) channels.erase(channels.begin());
  }
  if (counted) channels.push_back(samples_channel(job, frame_result));
  return channels;
}

}  // namespace kdray::api
