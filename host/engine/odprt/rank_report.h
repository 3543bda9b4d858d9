// What    What another rank's queues have done of a frame, as bytes for rank 0, which adds it to its own
//         result.
// Errors  ErrorCode::internal: bytes that are no report.
#pragma once

#include "engine/odprt/render.h"

namespace kdray::odprt {

transport::Bytes to_report(const Result& result, const RankTable& table);
void add_report(const transport::Message& message, const RankTable& table, Result& result);

}  // namespace kdray::odprt
