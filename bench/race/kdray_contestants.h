// What    kdray's traversals as contestants.
// Shape   A traversal's time is the one that Renderer::statistics() gives: rays and scene already on the
//         device.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "bench/race/race.h"

namespace kdray::bench {

// binary, wide, packet, batch, auto.
std::span<const std::string_view> traversal_names();

Traversal traversal_of(std::string_view name);

Contestant kdray_contestant(const std::shared_ptr<Renderer>& renderer, const std::string& traversal);

}  // namespace kdray::bench
