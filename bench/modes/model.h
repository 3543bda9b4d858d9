// What    A model of both modes: from the measured costs of a scene's tiles and from a sample of its rays it
//         predicts, by simulation, what 1 to 10,000 queues of one core each would take for the frame over a
//         stated network.
// Shape   PDPRT: the tiles' seconds through tiles.h. ODPRT: the wide tree cut into subtrees and assigned
//         to queues as host/engine/odprt does it, by the cost of a pilot sample; the lives of a larger sample
//         (lives.h) sent along the subtrees they pass (paths.h, traffic.h) through events.h. Both
//         are scaled to one core's measured time.
// Why     docs/bench.md has the assumptions and the limits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "accel/prepare/prepared.h"
#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::bench {

inline constexpr std::array kModelQueues = {1, 2, 4, 8, 10, 30, 100, 300, 1000, 3000, 10000};

struct ModelOptions {
  double gigabytes_per_second = 10;  // of a link, each direction
  double latency_us = 2;
  double service_us = 0.2;  // that a bag of tiles needs for a request
  double bytes_per_ray = 64;
  int subtrees_per_queue = 16;
  int sample = 1 << 16;  // eye rays; the pilot sample has a quarter as many
};

struct ModelInput {
  const scene::Scene& scene;
  const prepare::Prepared& prepared;
  double sequential_seconds;             // the frame by one core
  std::optional<double> odprt_overhead;  // measured: ODPRT on one queue, over PDPRT on one
  std::vector<int> queues;
};

struct Prediction {
  std::string scheme;  // as in ModesRow
  int queues = 1;
  double seconds = 0;
  double efficiency = 0;  // sequential seconds over queues times seconds
  // PDPRT
  std::size_t tiles = 0;
  // ODPRT
  std::size_t subtrees = 0;
  double balance = 0;        // mean work of a queue over the largest: the efficiency without a network
  double port_seconds = 0;   // that the busiest port is carrying
  double critical_path = 0;  // seconds
  double rays_sent = 0, bytes_sent = 0;
  double largest_geometry = 0;  // share of the geometry that a queue holds
};

// Rays of a kind in the sample, times the pixels that a sample ray stands for, and in the frame.
struct SampledRays {
  std::string kind;
  double sampled = 0, measured = 0;
};

struct Model {
  double rays_per_sample = 1;           // that a ray of the sample stands for: the rays of a message
  int tile_width = 0, tile_height = 0;  // measured; 0: there were no tiles' times
  double tiles_over_sequential = 0;     // the tiles' seconds together, over one core's for the frame
  double odprt_overhead = 1;
  bool overhead_measured = false;
  std::vector<SampledRays> rays;
  std::vector<Prediction> predictions;

  const Prediction* find(const std::string& scheme, int queues) const;
};

// `renderer` is the scene's on one core, `frame` the frame that took it `sequential_seconds`.
Model predict_modes(const ModelInput& input, Renderer& renderer, RenderOptions frame,
                    const ModelOptions& options);

}  // namespace kdray::bench
