// What    The options of render, which view has as well, on what a picture is made of, and on how its work is
//         divided among queues.
// Errors  kdray::Error, ErrorCode::usage.
#pragma once

#include <CLI/CLI.hpp>

#include "kdray/kdray.h"

namespace kdray::cli {

// --size --depth --min-weight --samples --grid
void add_picture_options(CLI::App& app, RenderOptions& options);

// --mode --division --balance --tile --ray-buffer --device-memory
void add_division_options(CLI::App& app, RenderOptions& options);

}  // namespace kdray::cli
