// What    Renders a frame over a divided scene, band by band.
// Errors  QueueFailures (below) when devices of queues failed; others are thrown as they are.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "device/opencl/opencl_error.h"
#include "engine/odprt/division.h"
#include "engine/odprt/provision.h"
#include "engine/odprt/render.h"

namespace kdray::odprt {

// A queue's failure that the other queues may stand in for, on its way from where it is noticed to where
// the scene is divided anew without the queue (render.cpp); in PDPRT pdprt/worker_pool.h does this. What no
// other queue may take over (device/opencl/opencl_error.h) is thrown on as it is.
struct QueueFailure {
  std::size_t queue = 0;  // its place in the request
  Error error;
};

struct QueueFailures : std::runtime_error {
  explicit QueueFailures(std::vector<QueueFailure> of_queues)
      : std::runtime_error(of_queues.front().error.what()), failures(std::move(of_queues)) {}
  std::vector<QueueFailure> failures;  // in the order of the queues
};

// Runs `call`, which uses the device of one queue.
template <class Call>
decltype(auto) on_queue(std::size_t queue, const std::string& doing, Call&& call) {
  try {
    return call();
  } catch (const QueueFailures&) {
    throw;  // of another queue, on which this call waits
  } catch (...) {
    throw QueueFailures({{queue, device::error_of_queue(std::current_exception(), doing)}});
  }
}

Result render_frame(const Request& request, const Provision& provision, const Division& division,
                    const Cut& cut);

}  // namespace kdray::odprt
