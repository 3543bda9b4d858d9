// What    A frame as the lives of its rays, for the simulation of ODPRT: what each ray costs in each part,
//         and which rays it leads to, once the scene is divided among so many ranks.
// Shape   The lives are the frame's own, a ray for a ray (bench/modes/lives.h): its pixels' eye rays and all
//         that comes of them. Rays that the renderer leaves out, since they provably meet nothing, are left
//         out by number: so many of those that meet nothing as the frame was found to have fewer. The scene
//         is cut and dealt out by ODPRT's own code, with costs of a pilot sample. Costs of walks and hits are
//         such that all together take one queue's measured time.
// Units   Seconds of a core by itself.
#pragma once

#include <array>
#include <vector>

#include "bench/modes/traffic.h"
#include "kdray/kdray.h"
#include "odprt/shares.h"

namespace kdray::bench {

// What one queue told of the frame in ODPRT.
struct OdprtCosts {
  double busy = 0;                  // of the queue
  double trace_share = 1;           // of that, what walks took
  double of_sent_ray = 0;           // what a ray that goes by mail takes more, on both sides together
  double end_seconds = 0;           // of the frame, beside what the queue was busy
  std::array<double, 4> rays = {};  // of the frame, by LifeKind; 0: as many as there are
};

struct LivedFrame {
  int width = 0, height = 0, depth = 5, tile = 8;
  std::size_t n_lights = 0;
  bool reflects = false, transmits = false;
  std::vector<LifeRay> lives, pilot;
  Rates rates;
};

// For so many ranks of a queue each.
struct DividedFrame {
  Traffic traffic;                           // a journey for each life
  std::vector<char> is_shadow;               // of each
  std::vector<std::uint32_t> tile_of_first;  // of each of traffic.first
  odprt::Dealt tiles;                        // numbers of tiles, as they are dealt out
  std::size_t n_tiles = 0;
  std::vector<std::size_t> pixels_of;  // that each queue adds something to
};

LivedFrame live(const PreparedScene& scene, const Scene& model, const std::string& device, int width,
                int height, int depth, int tile, const OdprtCosts& costs);
// Leaves out what the frame has fewer rays of a kind than there are lives: evenly, of those that meet
// nothing.
std::vector<LifeRay> leave_out(std::vector<LifeRay> lives, const std::array<double, 4>& rays);

// A ray is traced where it is made before another part is asked.
void trace_where_made(Journey& journey, bool is_shadow);

DividedFrame divide(const LivedFrame& frame, const PreparedScene& scene, int ranks);

}  // namespace kdray::bench
