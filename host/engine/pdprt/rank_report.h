// What    What a rank's queues have done of a frame, as bytes for rank 0, which adds it to its own result.
// Errors  ErrorCode::internal: bytes that are no report.
#pragma once

#include "engine/pdprt/render.h"

namespace kdray::pdprt {

transport::Bytes to_report(const Result& result);
void add_report(const transport::Message& message, Result& result);

}  // namespace kdray::pdprt
