// What    ODPRT: renders a frame with the scene divided among queues: each holds some subtrees, and rays
//         travel between them.
// Source  T. V. Christensen, "Parallel Ray Tracing", DTU 2009: object-distributed parallel ray tracing.
// Errors  A queue whose device fails, or has too little memory, is left out from then on: the scene is
//         divided among the others, and the frame begun anew. The error itself when no queue is left, or
//         there are other ranks. Any other error ends the frame (device/opencl/opencl_error.h).
// Ranks   All call render(), with the same frame. Rank 0 has the picture; the result of the others has none.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cluster/transport/together.h"
#include "engine/frame/driver.h"
#include "engine/frame/result.h"
#include "engine/odprt/division.h"
#include "engine/odprt/exchange.h"
#include "engine/odprt/rank_table.h"
#include "engine/wavefront/programs.h"
#include "kdray/options.h"

namespace kdray::odprt {

struct Queue {
  const device::Context* context = nullptr;
  cl::CommandQueue queue;
  wavefront::Programs* programs = nullptr;
  std::size_t number = 0;       // among all queues, also those that are left out
  std::size_t work_group = 64;  // local size, where every ray has a work-item
};

// Its frame is with tiles.
struct Request : frame::Request {
  std::vector<Queue> queues = {};
  RankTable table = {};  // of them, and of other ranks'
  Traversal traversal = Traversal::automatic;
  Balance balance = Balance::sah;
  std::uint32_t n_slices = 16;  // of each queue: enough for all of its compute units
  // Rays of a wave where every ray has a work-item: on all devices or on none; 0: slices.
  std::uint32_t wave_rays = 0;
  std::uint32_t ray_buffer = 0;
  std::uint64_t device_memory = 0;
  std::uint32_t census_every = 0;  // visits to subtrees are counted in one wave of so many
};

// A ray counts wherever a hit of it was looked for.
struct QueueReport : frame::QueueReport {
  std::uint64_t launches = 0, waves = 0;
  std::uint32_t n_parts = 0, n_subtrees = 0;
  std::uint64_t n_loads = 0;       // of parts
  std::size_t geometry_bytes = 0;  // the most at one time
};

struct Quarantined {
  std::size_t queue = 0;
  std::string what;
};

struct Result : frame::Result {
  double divide_seconds = 0;
  bool per_ray = false;  // every ray had a work-item
  std::vector<QueueReport> queues;
  ExchangeCounts exchange{0};
  std::vector<SubtreeUse> visits;             // of each subtree, where counted
  std::vector<std::uint32_t> subtree_queues;  // the number of the queue that holds it, or kEveryPart
  std::vector<Quarantined> quarantined;
  std::uint32_t n_parts = 0, n_cells = 0;
  std::vector<std::uint64_t> peak_bytes;  // of each rank's process, so far; 0: not known
};

struct Provision;

// A scene that frames are rendered of, and what has been learned about its costs.
class DividedScene {
 public:
  // `all`: of ranks, if the scene is what this one holds of it (division.h); they have one table in
  // all frames.
  DividedScene(flatten::FlatScene flat, flatten::WideForm wide,
               std::shared_ptr<transport::Together> all = nullptr);

  Result render(const Request& request);

  // From the next frame on.
  void light(const flatten::FlatScene& seen);

  const Cut& cut() const { return cut_; }
  // Of the whole scene; where it is held by ranks, once a frame was rendered.
  std::size_t geometry_bytes() const { return all_ ? held_bytes_ : odprt::geometry_bytes(flat_, wide_); }

 private:
  void cut_for(std::uint32_t n_parts);
  void cut_into(std::size_t n_subtrees);
  void divide_by(const DivideOptions& options);
  void measure_costs(const Request& request);
  void weigh(std::span<const SubtreeUse> visits);
  double cost_of(const SubtreeUse& use, std::size_t subtree) const;
  void learn(const Result& result);
  Provision divide_for(const Request& request);
  Provision divide_with_ranks(const Request& request);
  Provision divide_what_is_held(const Request& request);
  Provision divide_as_asked(const Request& request);
  void check_division(std::span<const std::uint32_t> part_of, std::uint32_t n_parts) const;
  Result render_once(const Request& request);

  flatten::FlatScene flat_;
  flatten::WideForm wide_;
  std::size_t n_asked_ = 0;  // subtrees that the cut was to have
  Cut cut_;
  std::vector<double> costs_;  // of the subtrees, by which they are assigned
  bool measured_ = false;      // costs_ come from rays
  std::optional<Division> division_;
  DivideOptions divided_by_;
  std::shared_ptr<transport::Together> all_;
  std::size_t held_bytes_ = 0;  // by all ranks
};

}  // namespace kdray::odprt
