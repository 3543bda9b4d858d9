// What    Renders a frame over a divided scene, band by band.
// Errors  QueueFailure when a queue's device failed, with its place in the request; others are thrown as they are.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>

#include "odprt/division.h"
#include "odprt/provision.h"
#include "odprt/render.h"

namespace kdray::odprt {

struct QueueFailure : std::runtime_error {
  QueueFailure(std::size_t failed, std::exception_ptr thrown, const std::string& what)
      : std::runtime_error(what), queue(failed), error(std::move(thrown)) {}
  std::size_t queue;
  std::exception_ptr error;
};

Result render_frame(const Request& request, const Provision& provision, const Division& division,
                    const Cut& cut);

}  // namespace kdray::odprt
