// What    Renders a frame over a divided scene, band by band.
// Errors  QueueFailures when devices of queues failed; others are thrown as they are.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "odprt/division.h"
#include "odprt/provision.h"
#include "odprt/render.h"

namespace kdray::odprt {

struct QueueFailure {
  std::size_t queue = 0;  // its place in the request
  std::exception_ptr error;
  std::string what;
};

struct QueueFailures : std::runtime_error {
  explicit QueueFailures(std::vector<QueueFailure> of_queues)
      : std::runtime_error(of_queues.front().what), failures(std::move(of_queues)) {}
  std::vector<QueueFailure> failures;  // in the order of the queues
};

Result render_frame(const Request& request, const Provision& provision, const Division& division,
                    const Cut& cut);

}  // namespace kdray::odprt
