// What    Renders a frame over a divided scene, band by band.
// Errors  QueueFailures (queue_failure.h) when devices of queues failed; others are thrown as they are.
#pragma once

#include "engine/odprt/division.h"
#include "engine/odprt/provision.h"
#include "engine/odprt/render.h"

namespace kdray::odprt {

Result render_frame(const Request& request, const Provision& provision, const Division& division,
                    const Cut& cut);

}  // namespace kdray::odprt
