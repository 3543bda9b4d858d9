// What    The lines at the end of a run, on stderr: what was made, where the time went, what was left
//         out. Every figure comes from the run's own statistics (stats.h).
#pragma once

#include <string>

#include "cli/stats.h"

namespace kdray::cli {

// "load 1.2 ms, build 3.4 ms, ...; 5.6 s in all"
std::string stages_line(const Json& stats);

// "1.05 M eye, 2.3 M shadow, ...: 12.3 Mrays/s"
std::string rays_line(const Json& stats);

// "no cones, no refraction; 1 of 10 programs built; 41% of 2.3 M shadow rays proven needless"; empty when
// nothing was left out.
std::string left_out_line(const Json& stats);

// "4.1 samples per pixel in 4 rounds; error believed to be 0.0069 RMSE, below the target 0.0075"; empty when
// not adaptive.
std::string samples_line(const Json& stats);

void print_render_summary(const Json& stats, std::size_t nan_values);
void print_trace_summary(const Json& stats, const std::string& hits_file, std::size_t rays, std::size_t hits);

}  // namespace kdray::cli
