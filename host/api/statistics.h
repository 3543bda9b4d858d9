// What    Gathers what a Renderer has done into the JSON of docs/cli.md (`--stats`).
// Units   Seconds of wall time, except seconds.{trace,shade,admit,add}: device time, added over the queues.
#pragma once

#include <nlohmann/json.hpp>

#include "kdray/kdray.h"
#include "layout/features.h"
#include "pdprt/render.h"
#include "prepare/prepared.h"

namespace kdray::api {

using Json = nlohmann::json;

Json scene_json(const prepare::Prepared& scene);
Json tree_json(const prepare::Prepared& scene);
Json device_json(const DeviceInfo& info);
Json features_json(layout::Features mask);
Json rays_json(const wavefront::Counters& counters);

// `adaptive`: null where all pixels have the frame's samples.
Json samples_json(const layout::Frame& frame, const adaptive::Report* adaptive);

// What is a mode's own: its queues and what it divided among them.
Json pdprt_json(const pdprt::Result& result);
Json pdprt_memory_json(const pdprt::Result& result, std::size_t scene_bytes);

}  // namespace kdray::api
