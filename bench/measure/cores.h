// What    How many cores a run has: kdray's on a CPU, and as many threads for those beside it.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

namespace kdray::bench {

// `device` is what Renderer::statistics() has under that key. A GPU's compute units say nothing of the cores
// that others may use.
inline int cores_of(const nlohmann::json& device) {
  const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return device.at("kind") == "cpu" ? std::min(all, device.at("compute_units").get<int>()) : all;
}

}  // namespace kdray::bench
