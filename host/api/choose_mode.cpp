#include "api/choose_mode.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/pdprt/render.h"

namespace kdray::api {

const Device* too_small_for_an_array(const State& state) {
  for (const Device& d : state.devices)
    if (state.scene.largest_array() > d.context.info().max_allocation) return &d;
  return nullptr;
}

std::optional<std::size_t> film_left_by_limit(const State& state, const Device& device, const Job& job) {
  // A place of the film holds three sums; adaptive sampling lists each of its places twice.
  constexpr std::size_t kPlace = 3 * sizeof(layout::i64), kListed = 2 * sizeof(layout::u32);
  const wavefront::Schedule schedule = state.scheduler.schedule_for(device, job);
  layout::Frame frame = job.frame;
  schedule.apply(frame, job.features);
  const bool adaptive = job.options.adaptive_target > 0;
  const std::size_t row = std::size_t{frame.tile_height} * frame.width;
  const std::size_t least = (adaptive ? std::max(row, pdprt::kLeastSamples) : row) * kPlace;
  const std::size_t n_queues = device.context.queues().size();
  const std::size_t taken = state.scene_bytes + n_queues * schedule.stream_bytes(frame, job.features);
  if (taken > job.options.device_memory) return std::nullopt;
  std::size_t left = (job.options.device_memory - taken) / n_queues;
  if (adaptive) left = left / (kPlace + kListed) * kPlace;
  return left < least ? std::nullopt : std::optional(left);
}

std::size_t film_bytes(const State& state, const Job& job) {
  std::size_t bytes = pdprt::Task().max_film_bytes;
  for (const Device& d : state.devices) {
    bytes = std::min<std::size_t>(bytes, d.context.info().max_allocation);
    if (job.options.device_memory == 0) continue;
    const std::optional<std::size_t> left = film_left_by_limit(state, d, job);
    if (!left)
      throw Error(
          ErrorCode::out_of_memory,
          fmt::format("a device memory of {} is too little for pdprt, which has the whole scene ({}M) on "
                      "every device; take more, or mode odprt",
                      job.options.device_memory, (state.scene_bytes >> 20) + 1));
    bytes = std::min(bytes, *left);
  }
  return bytes;
}

namespace {

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{}M", (bytes >> 20) + 1);
}

// Why the whole scene is too much for a device; empty when it is not.
std::string why_it_does_not_fit(const State& state, const Job& job, const std::string& scene_takes) {
  const auto is_limited = [&](const Device& d) { return !film_left_by_limit(state, d, job); };
  if (job.options.device_memory > 0 && std::ranges::any_of(state.devices, is_limited))
    return fmt::format("{}, with a frame's rays and film more than the device memory of {}", scene_takes,
                       job.options.device_memory);
  // Channels need every array whole.
  if (const Device* d = too_small_for_an_array(state); d != nullptr && job.options.channels.empty())
    return fmt::format("an array of the scene takes {}, {} gives {} in one piece",
                       megabytes(state.scene.largest_array()), d->context.info().name,
                       megabytes(d->context.info().max_allocation));
  for (const Device& d : state.devices)
    if (state.scene_bytes > d.context.info().global_memory)
      return fmt::format("{}, {} has {}", scene_takes, d.context.info().name,
                         megabytes(d.context.info().global_memory));
  return {};
}

}  // namespace

ChosenMode choose_mode(const State& state, const Job& job) {
  if (job.options.mode != Mode::automatic) return {job.options.mode, "asked for"};
  if (job.options.precision == Precision::float64) return {Mode::pdprt, "double precision has no other"};
  const std::string scene_takes = fmt::format("the scene takes {}", megabytes(state.scene_bytes));
  if (const std::string why = why_it_does_not_fit(state, job, scene_takes); !why.empty())
    return {Mode::odprt, why};
  const Speeds& s = state.speeds;
  if (!state.ranks && s.are_of(job.frame) && s.odprt > s.pdprt && s.pdprt > 0)
    return {Mode::odprt, fmt::format("measured {:.3g} Mrays/s, pdprt {:.3g}", s.odprt, s.pdprt)};
  return {Mode::pdprt, fmt::format("{} and fits every device whole", scene_takes)};
}

}  // namespace kdray::api
