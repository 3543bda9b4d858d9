// What    What tests, benches and the command line's hidden options do to a Renderer beyond its public
//         interface. This header is not installed.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "accel/flatten/core.h"
#include "base/hash.h"
#include "cluster/transport/together.h"
#include "kdray/kdray.h"

namespace kdray::transport {
class Ranks;
}
namespace kdray::engine {
class DeviceScene;
}

namespace kdray::api {

// What is known of a whole scene where a Renderer is made of a part of it: the partition of a rank
// (host/cluster/partition).
struct WholeScene {
  flatten::Core core;
  Hash primitives;                             // the sum of all ranks' (flatten/scene_hash.h)
  std::shared_ptr<transport::Together> ranks;  // by which they are joined, for the whole run
};

struct Hooks {
  // "1@5,0@9" makes the fifth launch on queue 1 and the ninth on queue 0 fail as if the device had;
  // "self-test@0" makes device 0 fail the self-test.
  std::string faults = {};
  // What every kernel is compiled with beside kdray's own options.
  std::string build_options = {};
  // Bits of kernels/layout/features.h and rules.h: what is compiled and done though the scene doesn't need
  // it.
  std::uint64_t keep = 0;
  // Other processes that render the same frames, one after the other: of rank 0 the pictures are whole, those
  // of the others are empty. Null: there are none.
  std::shared_ptr<transport::Ranks> ranks = {};
  // With ranks, for frames in ODPRT alone: the scene is what this rank holds of one that no rank has whole.
  // Null: each has all of it.
  std::shared_ptr<const WholeScene> whole = {};
};

// On devices that have the scene already, and may answer queries meanwhile.
Renderer make_renderer(std::shared_ptr<engine::DeviceScene> devices);
Renderer make_renderer(const PreparedScene& scene, const DeviceOptions& device, const Hooks& hooks);
Renderer make_renderer(const Scene& scene, const TreeOptions& tree, const DeviceOptions& device,
                       const Hooks& hooks);

// Hooks::keep, from the next frame on.
void keep(Renderer& renderer, std::uint64_t bits);

// kdray::open_device() with faults.
OpenSeconds open_device(const DeviceOptions& device, const Hooks& hooks);

}  // namespace kdray::api
