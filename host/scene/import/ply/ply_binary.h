// What    The fast paths of binary PLY files: vertices without lists, column by column, and faces that are
//         nothing but triangles of 32-bit indices after a one-byte count. Everything else ply.cpp reads value
//         by value.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "scene/import/ply/ply_columns.h"
#include "scene/import/ply/ply_header.h"
#include "scene/import/ply/ply_mesh.h"
#include "scene/import/ply/ply_source.h"

namespace kdray::scene::ply {

// Fills the arrays that there are columns for, which have element.count entries, for which the source has the
// bytes. False: some value is not finite.
template <bool swap>
bool read_columns(BinarySource<swap>& source, const Element& element, const VertexColumns& columns,
                  VertexArrays& out);

// Reads rows as long as they are good triangles, and says how many those were.
template <bool swap>
std::uint64_t read_triangles(BinarySource<swap>& source, const Element& element, Mesh& mesh);

}  // namespace kdray::scene::ply
