// What    The JSON of a report, and what all reports write of repeated measurements.
#pragma once

#include <nlohmann/json.hpp>

#include "bench/measure/spread.h"

namespace kdray::bench {

using Json = nlohmann::ordered_json;

inline Json json_of(const Spread& s) {
  return {{"median", s.median}, {"min", s.min}, {"max", s.max}};
}

}  // namespace kdray::bench
