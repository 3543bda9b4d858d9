// What    The options of render on where the picture is seen from and what is behind it: --from --at --up
//         --fov --camera --ortho --aperture --focus --headlight --background.
// Errors  kdray::Error, ErrorCode::usage.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <vector>

#include "kdray/kdray.h"

namespace kdray::cli {

struct ViewOptions {
  View view;
  bool transparent = false;  // --background transparent
  bool any = false;          // whether one was given
};

void add_view_options(CLI::App& app, ViewOptions& options);

// What share of each pixel eye rays hit anything in, for the samples that `render` asks for.
std::vector<float> coverage(const PreparedScene& scene, const DeviceOptions& device,
                            const RenderOptions& render);

// Takes out of each pixel what eye rays that hit nothing have brought from the background.
void take_out_background(std::span<const float> coverage, std::span<const float, 3> background,
                         std::vector<float>& rgb);

}  // namespace kdray::cli
