// What    The figures of what a Renderer has done, as values: times, rays, the tree, memory, devices, and how
//         the work was divided. docs/statistics.md tells of each by its name in JSON.
// Units   Seconds of wall time, except trace, shade, admit, add and route of a frame: device time, added over
//         the queues; bytes.
// Shape   What is told by one kind of work alone is optional. Filled in by the Renderer; what only a program
//         knows that uses it (reading, writing, the total) is that program's to fill in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kdray/device_info.h"
#include "kdray/options.h"

namespace kdray {

struct Statistics {
  struct Seconds {
    double cache = 0, load = 0;  // looking the scene up and keeping it; reading its file
    double start = 0;            // opening OpenCL and the devices, without the self-test
    double self_test = 0;        // of the devices, where it was not known that they pass
    double build = 0, flatten = 0, upload = 0, compile = 0;
    double prepare =
        0;  // a frame's or a query's buffers, and its kernels' first launch, which drivers compile at
    double trace = 0, shade = 0, render = 0;
    std::optional<double> admit, add;     // of a frame
    std::optional<double> divide, route;  // of a frame in ODPRT
    std::optional<double> read_rays;      // of a query
    double keep_programs = 0;             // writing what was compiled, for later processes
    double write = 0, total = 0;
  };

  struct Scene {
    std::uint64_t primitives = 0;                              // of the file, degenerate ones too
    std::vector<std::pair<std::string, std::uint64_t>> kinds;  // of each kind those that can be hit
    std::uint64_t stitches = 0;                                // triangles without area that may close gaps
    std::uint64_t lights = 0, materials = 0, dropped_degenerate = 0;
  };

  struct Tree {
    std::string build;  // the quality it was made with
    std::uint64_t nodes = 0, inner_nodes = 0, leaves = 0, empty_leaves = 0, references = 0;
    double duplication = 0;  // references for each primitive
    std::uint32_t largest_leaf = 0;
    int max_depth = 0;
    double mean_leaf_depth = 0, sah_cost = 0;
  };

  struct Rays {
    // Rays that were not traced, by the reason.
    struct Skipped {
      std::uint64_t light_behind = 0, light_of_no_weight = 0, light_in_the_open = 0;
      std::uint64_t of_the_background = 0, below_min_weight = 0, too_deep = 0;
      std::uint64_t too_deep_in_glass = 0;  // of too_deep: refracted rays that matter to their pixel
    };
    // Of a frame; a query has nothing but rays.
    struct Kinds {
      std::uint64_t primary = 0, primary_hit = 0, shadow = 0, reflected = 0, refracted = 0;
      Skipped skipped;
    };
    std::uint64_t total = 0;
    std::optional<Kinds> kinds;
  };

  struct QueueMemory {
    std::uint64_t geometry_bytes = 0, work_bytes = 0;
  };
  struct Memory {
    std::uint64_t scene_bytes = 0;
    std::optional<std::uint64_t> frame_bytes;  // of PDPRT
    std::vector<QueueMemory> per_queue;
  };

  struct Features {
    std::vector<std::string> on, off;
  };

  // Where the kernels' programs came from.
  struct Programs {
    std::uint64_t compiled = 0;      // by this process
    std::uint64_t found = 0;         // kept from an earlier one, for just these features
    std::uint64_t covering = 0;      // kept from an earlier one, for these features and more
    std::vector<std::string> spare;  // features that some of them have though the scene doesn't need them
  };

  // What a device's settings were looked for by, and where they are from.
  struct DeviceTuning {
    std::string from;  // "shipped", "given", or the file and the features of its entry
    Tuning settings;
    std::string device, driver, kernels, schedule, features;
  };

  struct Frame {
    std::uint32_t width = 0, height = 0, samples = 0, depth = 0;
    float spawn_threshold = 0;
  };

  // Of adaptive sampling.
  struct Adaptive {
    int rounds = 0;
    double target = 0, estimated_rmse = 0;
    bool met = false;                                             // the target
    std::vector<std::pair<std::uint32_t, std::uint64_t>> pixels;  // samples, and how many pixels have so many
  };
  struct Samples {
    std::uint64_t total = 0;
    double per_pixel = 0;
    std::optional<Adaptive> adaptive;  // none: all pixels have the same number
  };

  // Of a frame with a checkpoint: tiles, and runs of samples where sampling is adaptive. The frame's rays,
  // its times and what is told of queues are of those that were rendered by this process.
  struct Ledger {
    std::string folder;
    std::uint64_t pieces = 0, found = 0, rendered = 0;  // found: when their round began
    std::uint64_t damaged = 0, bytes_read = 0, bytes_written = 0;
    double seconds = 0;  // of reading, writing and waiting for other processes
  };

  // What a queue of ODPRT did beside tracing.
  struct Travel {
    std::uint64_t parts = 0, subtrees = 0, part_loads = 0, launches = 0;
    std::uint64_t rays_in = 0, rays_out = 0, bytes_in = 0, bytes_out = 0;
  };
  struct Queue {
    std::size_t number = 0;
    std::string device;
    double busy_seconds = 0, idle_share = 0;
    std::uint64_t rays = 0;
    std::optional<std::uint64_t> tiles;  // of PDPRT
    std::optional<Travel> travel;        // of ODPRT
    std::optional<int> rank;             // that it is of, where there are several
  };
  struct Quarantined {
    std::size_t queue = 0;
    std::string what;
  };

  // What PDPRT tells of a frame.
  struct Pdprt {
    std::string division;
    std::vector<double> tile_seconds;  // where a timeline was asked for
  };
  // What ODPRT tells of a frame. Of rays and bytes: row by row, those that the queue of the row's number
  // sent.
  struct Odprt {
    std::string balance;
    std::uint64_t parts = 0, directory_cells = 0, whole_geometry_bytes = 0;
    std::vector<std::vector<std::uint64_t>> rays, bytes;
    std::uint64_t rays_total = 0, bytes_total = 0;
  };
  // What rank 0 has sent and received of a run so far.
  struct Ranks {
    int ranks = 1;
    std::uint64_t messages_out = 0, messages_in = 0, bytes_out = 0, bytes_in = 0;
    bool whole = true;                           // each has the whole scene
    std::vector<std::uint64_t> peak_bytes = {};  // of ODPRT: the most that each process has had so far
  };
  // How a frame was divided and run, in whichever mode.
  struct Division {
    std::string why, schedule;
    std::vector<std::string> devices;
    std::uint64_t sub_devices = 0, programs = 0, programs_known = 0;
    std::uint32_t tile_width = 0, tile_height = 0, tiles = 0, bands = 0;
    std::uint64_t launches = 0, waves = 0;
    std::uint64_t samples_of_empty_blocks = 0;  // of primary: the picture shows nothing there
    std::vector<Queue> per_queue;
    std::vector<Quarantined> quarantined;
    std::optional<Pdprt> pdprt;
    std::optional<Odprt> odprt;
    std::optional<Ranks> ranks;
  };
  struct Mode {
    std::string name;  // "pdprt", "odprt", "query"; empty: nothing was done yet
    std::size_t queues = 0, work_group = 0;
    std::string traversal, precision;
    std::optional<Division> division;     // of a frame
    std::optional<std::uint64_t> repeat;  // of a query
  };

  Seconds seconds;
  Scene scene;
  Tree tree;
  Rays rays;
  double mrays_per_s = 0;
  Memory memory;
  Features features;
  Programs programs;
  DeviceInfo device;  // the first, which queries take
  DeviceTuning tuning;
  Mode mode;
  std::optional<Frame> frame;
  std::optional<Samples> samples;
  std::optional<Ledger> ledger;
};

}  // namespace kdray
