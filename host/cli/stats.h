// What    The figures of a run: what the renderer measured (Renderer::statistics()), with what only the
//         command line knows: the times of reading, writing and of everything, the input, and this
//         process's memory.
// Units   seconds, bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace kdray::cli {

using Json = nlohmann::ordered_json;

struct OwnSeconds {
  double load = 0;   // reading the scene file
  double cache = 0;  // looking the scene up in the cache, and keeping it there
  double write = 0;  // writing pictures or hits
  double total = 0;  // from the start of the command to now
};

Json collect_stats(const std::string& command, const std::string& scene,
                   const std::string& renderer_statistics, const OwnSeconds& seconds);

// The whole process at its largest, as the kernel counted it.
std::uint64_t peak_memory();

void write_stats(const std::filesystem::path& file, const Json& stats);

}  // namespace kdray::cli
