#include "api/channels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/odprt/assign.h"
#include "engine/odprt/subtrees.h"
#include "engine/pdprt/render.h"
#include "engine/wavefront/channels.h"
#include "io/image/color.h"

namespace kdray::api {

namespace {

dvec3 vector_of(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// The kernels' eye ray through a pixel's centre (raygen/primary.clh), in double.
dvec3 point_at(const layout::Frame& frame, std::uint32_t column, std::uint32_t row, double distance) {
  const double middle = frame.corner_grid ? 0 : 0.5;
  const double x = (column + middle) * frame.x_scale + frame.x_offset;
  const double y = (row + middle) * frame.y_scale + frame.y_offset;
  const dvec3 eye = vector_of(frame.eye), forward = vector_of(frame.forward);
  const dvec3 aside = vector_of(frame.right) * x + vector_of(frame.up) * y;
  if (frame.parallel) return eye + aside + safe_normalize(forward) * distance;
  return eye + safe_normalize(forward + aside) * distance;
}

float channel_of(std::uint32_t queue) {
  return queue == odprt::kEveryPart ? image::kEveryQueue : static_cast<float>(queue);
}

}  // namespace

std::vector<float> queues_by_tiles(const layout::Frame& frame, const Owners& owners) {
  const std::uint32_t n_tiles_x = (frame.width + owners.tile_width - 1) / owners.tile_width;
  std::vector<float> queues;
  queues.reserve(std::size_t{frame.width} * frame.height);
  for (std::uint32_t row = 0; row < frame.height; ++row)
    for (std::uint32_t column = 0; column < frame.width; ++column) {
      const std::uint32_t queue =
          owners.of_tiles[row / owners.tile_height * n_tiles_x + column / owners.tile_width];
      queues.push_back(queue == pdprt::kNobody ? image::kNoQueue : static_cast<float>(queue));
    }
  return queues;
}

std::vector<float> queues_by_subtrees(const State& state, const layout::Frame& frame, const Owners& owners,
                                      std::span<const float> depths) {
  const odprt::Locator locator(state.scene.wide, state.divided->cut());
  std::vector<float> queues(depths.size(), image::kNoQueue);
  tbb::parallel_for(std::uint32_t{0}, frame.height, [&](std::uint32_t row) {
    for (std::uint32_t column = 0; column < frame.width; ++column) {
      const std::size_t pixel = std::size_t{row} * frame.width + column;
      if (!std::isfinite(depths[pixel])) continue;
      const double distance = state.scene.geometry.space.local_length(depths[pixel]);
      const auto subtree = locator.find(vec3(point_at(frame, column, row, distance)));
      if (subtree) queues[pixel] = channel_of(owners.of_subtrees[*subtree]);
    }
  });
  return queues;
}

namespace {

image::Channel samples_channel(const Job& job, FrameResult& frame_result) {
  if (frame_result.samples) return {"samples", std::move(frame_result.samples->counts)};
  const std::size_t n_pixels = frame_result.rgb.size() / 3;
  return {"samples", std::vector<float>(n_pixels, static_cast<float>(job.frame.n_samples))};
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
