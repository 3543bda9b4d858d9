// What    A frame of PDPRT as one process sees it: what it is cut into, the lists of tiles and of samples
//         that it is made of, and where their sums go.
// Shape   render.cpp has whole pictures, frame_lists.cpp one list (alone or with other ranks),
//         frame_samples.cpp the rounds of adaptive sampling.
#pragma once

#include <optional>
#include <vector>

#include "engine/adaptive/sampler.h"
#include "engine/pdprt/tile_server.h"
#include "engine/pdprt/worker_pool.h"
#include "engine/wavefront/bands.h"

namespace kdray::pdprt {

class Frame {
 public:
  Frame(std::span<const Device> devices, const Task& task);
  Result render();
  // What every rank but 0 does of it.
  Result render_for_others();

 private:
  // Where the sums of a list's entries go.
  struct Destination {
    std::function<void(const wavefront::FilmSums&, std::span<const layout::u32> entries)> own;
    TileServer::Take of_others = {};
  };

  void render_uniform();
  void render_uniform_sums();
  void render_sums_of_tiles(std::span<layout::i64> sums);
  void render_adaptive();
  void render_bands(const Destination& to);
  Destination to_picture(std::span<layout::i64> sums) const;

  void render_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums);
  void render_kept_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums);
  std::vector<layout::u32> render_runs(std::size_t first, std::vector<layout::u32> runs,
                                       std::span<const layout::u32> samples, std::span<layout::i64> sums,
                                       double seconds);

  // Return what nobody had begun when the time was over.
  std::vector<layout::u32> render_list(std::vector<layout::u32> list, const Work& work, const Destination& to,
                                       double seconds);
  std::vector<layout::u32> render_list_alone(std::vector<layout::u32> list, const Work& work, double seconds);
  std::vector<layout::u32> serve_list(std::vector<layout::u32> list, const Work& work,
                                      TileServer::Take of_others, double seconds);
  void render_assigned(class TileClient& client);
  void check_entries(const Begin& list) const;

  void tell_progress() const;
  void idle();
  SharedFrame shared_frame() const;
  TileHierarchy hierarchy() const;
  Result collect(double seconds);
  void add_reports(Result& result);

  const Task& task_;
  layout::Frame frame_;
  std::vector<wavefront::Band> bands_;
  wavefront::Capacity capacity_;
  image::Image image_;
  std::optional<adaptive::Sampler> sampler_;  // adaptive sampling
  std::optional<WorkerPool> pool_;
  std::optional<TileServer> server_;            // of rank 0
  double progress_from_ = 0, progress_to_ = 1;  // of the share done: what n_tiles_ are
  std::uint64_t n_tiles_ = 0;                   // of the lists of a round
  std::uint64_t n_of_others_ = 0;               // of these, in lists that are over
  std::uint32_t n_rounds_ = 1;                  // that were begun, of a frame with a checkpoint
};

}  // namespace kdray::pdprt
