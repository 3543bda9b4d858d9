// What    The frame as it is rendered: by one core alone, by several cores at once that know nothing of each
//         other, and by ranks; and what of it the simulation replays.
// Shape   A round has each of them once, in turn, so that what slows the machine slows all; one round before
//         is not counted. Frames alone give each tile's cost, frames at once how fast so many queues are that
//         share this machine's cores, and how often a thread gets to look at messages meanwhile.
// Units   Seconds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/measure/spread.h"
#include "bench/ranks/lived_frame.h"
#include "bench/ranks/ping_pong.h"
#include "bench/ranks/pretend_queue.h"
#include "bench/ranks/team.h"
#include "kdray/kdray.h"

namespace kdray::bench {

// Real frames by ranks.
struct RealRanks {
  int ranks = 1;
  double delay = 0;
  std::vector<double> rounds = {};  // seconds
  double messages = 0, bytes = 0;   // of rank 0, both ways, for a frame; medians
  double busy = 0;                  // of all queues together; median
  double rays_sent = 0;             // from queue to queue, in ODPRT; median
  std::size_t differing_pixels = 0;
};

// So many frames at once, each by itself.
struct AtOnce {
  double speed = 1;    // of each, as a part of one that is alone
  double look = 1e-3;  // between two looks of a thread that wants to look every millisecond
};

// What was measured in one round, in turn with real frames.
struct RanksRound {
  double alone = 0;
  std::map<int, AtOnce> at_once;  // by how many
};

struct RanksMeasured {
  std::string device;
  MessageCosts messages;
  ReplayedFrame frame;
  Spread alone;  // the frame by one core
  double busy = 0;
  std::map<int, AtOnce> at_once;  // by how many; medians
  std::vector<RanksRound> rounds;
  std::vector<RealRanks> real;
  // The same in ODPRT, of a frame of half as many pixels across and down.
  int odprt_width = 0, odprt_height = 0;
  Spread odprt_alone;
  OdprtCosts odprt;
  std::vector<RealRanks> real_odprt;
};

struct RanksAsked {
  std::vector<int> ranks = {1, 2, 4, 8};
  std::vector<double> delays = {0, 2.5e-3};
  int width = 1024, height = 1024, depth = 5, samples = 1, tile = 8, repeat = 7;
  std::string device = "auto";
  bool odprt = true;  // too
};

// All members call it with the same; what member 0 gets counts.
RanksMeasured measure_ranks(Team& team, const PreparedScene& scene, const RanksAsked& asked);

}  // namespace kdray::bench
