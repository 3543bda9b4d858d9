// What    The end of a run in words, on stderr: what was made, and how fast, in one line; with --verbose also
//         where the time went and what was left out. Every figure comes from the run's own statistics
//         (stats.h).
#pragma once

#include <string>

#include "apps/cli/stats.h"

namespace kdray::cli {

// "balls.png: 1024x1024, 5.5 M rays in 130 ms, 42 Mrays/s; 450 ms in all"
std::string render_line(const Json& stats);

// "hits.npy: 3 of 5 rays hit, in 1 ms, 0.005 Mrays/s; 20 ms in all", or what else was asked.
std::string trace_line(const Json& stats);

// "a first start took 8.2 s of it (compiling kernels 6.1 s, ...); the next finds the kernels built"; empty
// when they were found.
std::string cold_start_line(const Json& stats);

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

// A larger --depth to try, where rays through stacked glass were cut off that would have mattered; else
// empty.
std::string glass_line(const Json& stats);

// `is_first`: of the frames of a scene.
void print_render_summary(const Json& stats, std::size_t nan_values, bool verbose, bool is_first);
void print_trace_summary(const Json& stats, bool verbose);

}  // namespace kdray::cli
