// What    Statistics as JSON, by the names of docs/statistics.md (`--stats`). This header is not installed.
#pragma once

#include <nlohmann/json.hpp>

#include "kdray/statistics.h"

namespace kdray::api {

using Json = nlohmann::json;

Json statistics_json(const Statistics& statistics);

// The parts of it that reports hold by themselves.
Json device_json(const Statistics& statistics);

}  // namespace kdray::api
