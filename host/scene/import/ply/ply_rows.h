// What    Rows of a binary PLY file, read from any place in it: several processes each read a part.
// Shape   For files whose rows are all as long as the header says, without pictures or colours of faces:
//         vertices without lists, faces that are all triangles. For other files open() returns nothing, and
//         reading bad rows returns false; then the whole file is read by read_ply(), which copes with it or
//         says what is wrong.
// Memory  A piece of the file of some MiB, and what is returned.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

#include "base/memory.h"
#include "scene/import/ply/ply_header.h"
#include "scene/import/ply/ply_mesh.h"

namespace kdray::scene::ply {

struct RowRange {
  std::uint64_t first = 0, n = 0;
};

using Vertices = VertexArrays;  // without texture coordinates
using Corners = std::array<std::uint32_t, 3>;

class Rows {
 public:
  // Returns nothing where the file has to be read whole.
  static std::optional<Rows> open(const std::filesystem::path& file);

  std::uint64_t n_vertices() const { return vertices_.n; }
  std::uint64_t n_faces() const { return faces_.n; }
  const VertexColumns& columns() const { return columns_; }
  bool has_more() const { return has_more_; }  // behind the last element of the header
  std::vector<std::string> left_out() const { return left_out_of(header_, file_); }
  // Returns a hash of the header and the file's size, for ranks to agree on.
  std::uint64_t fingerprint() const { return fingerprint_; }

  // Return false where one of the rows is bad.
  bool read_vertices(const RowRange& range, Vertices& out);
  bool read_faces(const RowRange& range, RawVector<Corners>& out);

 private:
  struct Place {
    const Element* element = nullptr;
    std::uint64_t begin = 0;  // byte of the file
    std::uint64_t n = 0, stride = 0;
  };

  Rows() = default;
  bool place_elements(std::uint64_t file_bytes);
  bool place(const Element& element, std::uint64_t& at);
  // Calls use(first row, number, bytes) for pieces of the range, as long as it returns true.
  template <class Use>
  bool for_each_piece(const Place& place, const RowRange& range, const Use& use);

  std::string file_;
  std::ifstream in_;
  Header header_;
  Place vertices_, faces_;
  VertexColumns columns_;
  const Property* corners_ = nullptr;
  std::uint64_t corners_at_ = 0;  // byte of a face's row where its list begins
  bool has_more_ = false;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace kdray::scene::ply
