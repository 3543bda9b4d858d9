// What    What is known of a whole scene where a Renderer is made of a part of it: the partition of a rank
//         (host/cluster/partition).
#pragma once

#include <memory>

#include "accel/flatten/core.h"
#include "base/hash.h"
#include "cluster/transport/together.h"

namespace kdray::api {

struct WholeScene {
  flatten::Core core;
  Hash primitives;                             // the sum of all ranks' (flatten/scene_hash.h)
  std::shared_ptr<transport::Together> ranks;  // by which they are joined, for the whole run
};

}  // namespace kdray::api
