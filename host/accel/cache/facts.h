// What    What a prepared scene has beside its arrays, as CBOR (RFC 8949) and back.
// Errors  from_bytes throws std::exception where the bytes are none of to_bytes.
#pragma once

#include <string>
#include <string_view>

#include "accel/prepare/prepared.h"

namespace kdray::cache {

std::string to_bytes(const prepare::Prepared& prepared);

// Fills in all but the arrays, materials and lights.
void from_bytes(std::string_view bytes, prepare::Prepared& prepared);

}  // namespace kdray::cache
