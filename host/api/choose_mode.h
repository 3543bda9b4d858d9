// What    What fits on the devices, and so the choice between PDPRT and ODPRT for a frame that leaves it
//         open; or by what was measured, where this Renderer has rendered such a frame in both modes.
// Units   Bytes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

// The device that can't hold one of the scene's arrays in one piece, if there is one.
const Device* too_small_for_an_array(const State& state);

// All that scene and streams leave of RenderOptions::device_memory, shared by the device's queues. Nothing
// where that is less than a row of tiles, or a round of samples, takes.
std::optional<std::size_t> film_left_by_limit(const State& state, const Device& device, const Job& job);

// Of a queue on any of the devices. Throws ErrorCode::out_of_memory where RenderOptions::device_memory leaves
// too little.
std::size_t film_bytes(const State& state, const Job& job);

struct ChosenMode {
  Mode mode;
  std::string why;
};

ChosenMode choose_mode(const State& state, const Job& job);

}  // namespace kdray::api
