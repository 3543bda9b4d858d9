// What    The choice between PDPRT and ODPRT for a frame that leaves it open: by what fits; then by what was
//         measured, where this Renderer has rendered such a frame in both modes.
#pragma once

#include <string>

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

struct ChosenMode {
  Mode mode;
  std::string why;
};

ChosenMode choose_mode(const State& state, const Job& job);

}  // namespace kdray::api
