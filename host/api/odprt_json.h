// What    Turns what ODPRT tells of a frame into JSON.
#pragma once

#include "api/statistics.h"
#include "kdray/kdray.h"
#include "odprt/render.h"

namespace kdray::api {

// mode.* and memory.per_queue of the statistics. `bytes_of_whole` is the scene's geometry.
Json odprt_mode_json(const odprt::Result& result, const RenderOptions& options, std::size_t bytes_of_whole);
Json odprt_memory_json(const odprt::Result& result);

}  // namespace kdray::api
