#include "api/choose_mode.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "api/film_memory.h"

namespace kdray::api {

namespace {

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{}M", (bytes >> 20) + 1);
}

// Why the whole scene is too much for a device; empty when it is not.
std::string why_it_does_not_fit(const State& state, const Job& job, const std::string& scene_takes) {
  const auto is_limited = [&](const Device& d) { return !film_left_by_limit(state, d, job); };
  if (job.options.device_memory > 0 && std::ranges::any_of(state.devices, is_limited))
    return fmt::format("{}, with a frame's rays and film more than --device-memory {}", scene_takes,
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
