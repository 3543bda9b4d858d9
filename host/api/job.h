// What    A frame that is to be rendered, in whichever mode, and what comes of rendering it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/timeline.h"
#include "engine/checkpoint/frame_checkpoint.h"
#include "engine/frame/driver.h"
#include "engine/frame/result.h"
#include "kdray/kdray.h"
#include "kdray/statistics.h"
#include "layout/frame.layout.h"

namespace kdray::api {

struct Job {
  RenderOptions options;  // with what they leave open filled in from the scene
  layout::Frame frame;
  layout::Features features;
  timeline::Timeline* timeline;                                  // null: not wanted
  std::shared_ptr<checkpoint::FrameCheckpoint> checkpoint = {};  // null: there is none
  // With ranks: the frame's mark, and what a queue's film takes at most (agree).
  Hash shared_frame = {};
  std::size_t film_of_ranks = 0;
};

// Who traced what: of PDPRT the queue of each tile (by row and column), of ODPRT that of each subtree.
struct Owners {
  std::uint32_t tile_width = 0, tile_height = 0;
  std::vector<std::uint32_t> of_tiles = {}, of_subtrees = {};
};

struct FrameResult : frame::Result {
  std::vector<std::string> warnings;
  std::optional<double> divide_seconds;  // of ODPRT
  Owners owners;
  // For the statistics: how the frame was divided, and what it took of memory.
  Statistics::Division division;
  std::optional<std::uint64_t> frame_bytes;  // of PDPRT
  std::vector<Statistics::QueueMemory> memory_of_queues;
};

struct State;

// Fills in what the options leave open. Throws ErrorCode::usage for options that don't go together, or with
// the scene as it was prepared.
Job make_job(State& state, const RenderOptions& options, timeline::Timeline* timeline);

// What the job asks for in either mode.
frame::Request request_of(State& state, const Job& job);

inline double mrays_per_s(std::uint64_t rays, double seconds) {
  return seconds > 0 ? static_cast<double>(rays) / seconds * 1e-6 : 0.0;
}

// What tells a frame from others: for the checkpoint that is opened for it, and for ranks that render it
// together and agree on it beforehand. A checkpoint's header says all that matters for the bits of a
// picture. Rank 0 sends it, and decides the mode and how the frame is cut into tiles and bands. Errors:
// kdray::Error of a rank that has another scene, other settings or another build than rank 0, or less
// memory for its film.

// Puts the tiles into the job's options. Returns rank 0's mode.
Mode agree(State& state, Job& job, Mode mode);

// What tells the frame from others.
checkpoint::Identity identity_of(State& state, const Job& job);

// For a job whose options ask for one. Puts the checkpoint's tiles into the job's options.
void open_checkpoint(State& state, Job& job);

}  // namespace kdray::api
