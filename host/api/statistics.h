// What    Gathers what a Renderer has done into the JSON of DESIGN.md section 2 (`--stats`).
// Units   Seconds of wall time, except seconds.{trace,shade,admit,add}: device time, added over the queues.
#pragma once

#include <nlohmann/json.hpp>

#include "kdray/kdray.h"
#include "kdtree/statistics.h"
#include "pdprt/render.h"

namespace kdray::api {

using Json = nlohmann::json;

Json tree_json(const kdtree::Tree& tree, const kdtree::Statistics& statistics);
Json device_json(const DeviceInfo& info);
Json features_json(std::uint32_t mask);
Json rays_json(const wavefront::Counters& counters);

}  // namespace kdray::api
