// What    The numbers of glTF accessors: positions, normals, keyframes, matrices and indices, of any
//         component type, interleaved, normalised and sparse.
// Errors  kdray::Error with the accessor's path for everything that doesn't fit its buffer view, and, where
//         NotFinite doesn't say otherwise, for values that are not finite. An accessor without a buffer view
//         (all zeros) may not be much larger than the file.
#pragma once

#include <array>
#include <cstdint>

#include "base/memory.h"
#include "base/vec.h"
#include "scene/import/gltf/gltf_document.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene::gltf {

std::uint64_t accessor_count(const JsonNode& accessor);
// Reads VEC3 of floats, or of integers, which `normalized` scales to [-1, 1] or [0, 1].
RawVector<dvec3> read_vectors(Document& document, const JsonNode& accessor,
                              NotFinite other = NotFinite::refused);
// Reads VEC2 of the same.
RawVector<std::array<float, 2>> read_pairs(Document& document, const JsonNode& accessor,
                                           NotFinite other = NotFinite::refused);
// Reads VEC3 or VEC4 of the same: red, green, blue and alpha, which is 1 where there is none.
RawVector<std::array<float, 4>> read_colors(Document& document, const JsonNode& accessor,
                                            NotFinite other = NotFinite::refused);
// Read SCALAR, VEC4 and MAT4 of the same, with all parts.
RawVector<double> read_scalars(Document& document, const JsonNode& accessor);
RawVector<std::array<double, 4>> read_quads(Document& document, const JsonNode& accessor,
                                            NotFinite other = NotFinite::refused);
RawVector<dmat4> read_matrices(Document& document, const JsonNode& accessor);
// Reads SCALAR of unsigned integers, each below `end`.
RawVector<std::uint32_t> read_indices(Document& document, const JsonNode& accessor, std::uint64_t end);

}  // namespace kdray::scene::gltf
