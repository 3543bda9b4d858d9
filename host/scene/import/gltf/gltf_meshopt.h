// What    EXT_meshopt_compression, and KHR_meshopt_compression as far as it is the same: buffer views whose
//         bytes are packed.
// Shape   A packed stream makes 64 bytes of each of its own at most, which is checked before anything is
//         allocated.
// Errors  kdray::Error with the extension's path: sizes that don't fit each other, a damaged stream, a codec
//         or filter that libmeshoptimizer doesn't have, a kdray that was built without it.
// Source  Khronos Group, EXT_meshopt_compression and KHR_meshopt_compression.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "scene/import/gltf/gltf_document.h"

namespace kdray::scene::gltf {

// Whether this kdray was built with what it takes.
bool has_meshopt();

// What a buffer view says of its packed bytes; nothing for a plain one.
std::optional<JsonNode> meshopt_of(const JsonNode& view);

// How many bytes come of it, which is what the view says as well.
std::uint64_t meshopt_size(const JsonNode& view, const JsonNode& packed, std::uint64_t packed_size);

// Unpacks the stream. meshopt_size() was called for it before.
std::string unpack_meshopt(const JsonNode& packed, std::string_view bytes);

[[nodiscard]] Error no_meshopt(const JsonNode& packed);

}  // namespace kdray::scene::gltf
