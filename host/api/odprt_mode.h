// What    Renders in ODPRT for a Renderer, and tells how it went.
#pragma once

#include "kdray/kdray.h"
#include "odprt/render.h"
#include "statistics.h"

namespace kdray::api {

// The wide form is what is divided: other walks of it than asked for do, the binary tree's doesn't
// (ErrorCode::usage).
Traversal odprt_traversal(Traversal wanted, bool on_cpus);

// mode.* and memory.per_queue of the statistics. `bytes_of_whole` is the scene's geometry.
Json odprt_mode_json(const odprt::Result& result, const RenderOptions& options, std::size_t bytes_of_whole);
Json odprt_memory_json(const odprt::Result& result);

// One line for each queue that failed.
std::vector<std::string> warnings_of(const odprt::Result& result);

}  // namespace kdray::api
