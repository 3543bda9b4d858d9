// What    The figures of a run as JSON: what the renderer measured, and what the command line filled in
//         beside it (the times of reading, writing and of everything), with the input and this process's
//         memory.
// Units   seconds, bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "kdray/statistics.h"

namespace kdray::cli {

using Json = nlohmann::ordered_json;

Json collect_stats(const std::string& command, const std::string& scene, const Statistics& statistics);

// Returns the memory of the process at its largest, as the kernel counted it.
std::uint64_t peak_memory();

void write_stats(const std::filesystem::path& file, const Json& stats);

}  // namespace kdray::cli
