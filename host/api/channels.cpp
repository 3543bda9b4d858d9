#include "api/channels.h"

#include <algorithm>
#include <string>

#include "wavefront/channels.h"

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
  std::vector<film::Channel> channels;
  if (!traced.empty()) {
    Device& device = state.devices.first();
    channels =
        wavefront::render_channels(device.context, device.buffers(), device.programs, job.frame,
                                   state.scene.geometry.space, job.features, job.options.precision, traced);
  }
  if (counted) channels.push_back(samples_channel(job, drawn));
  return channels;
}

}  // namespace kdray::api
