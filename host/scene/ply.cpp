// What    PLY: polygons (element face) and triangle strips (element tristrips) over the element vertex,
//         with vertex normals and colours; ascii and binary, either byte order. Other elements and
//         properties are skipped.
// Errors  ascii: file and line; binary: file, element, row and byte.
// Source  G. Turk, "The PLY Polygon File Format", 1994. Tristrips as the Stanford scanning repository writes
//         them.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "scene/importers.h"
#include "scene/ply_binary.h"
#include "scene/ply_columns.h"
#include "scene/ply_header.h"
#include "scene/ply_left_out.h"
#include "scene/ply_mesh.h"
#include "scene/ply_source.h"

namespace kdray::scene {

namespace ply {
namespace {

constexpr std::uint64_t kMostVertices = 0xffffffffu;

template <class Source>
class BodyReader {
 public:
  BodyReader(const Header& header, Source& source, const std::string& file)
      : header_(header), source_(source), file_(file), mesh_(vertex_count()) {}

  Scene read() {
    for (const Element& element : header_.elements) {
      if (element.count == 0 || element.properties.empty()) continue;
      check_capacity(element);
      read_element(element);
    }
    const bool at_end = source_.at_end();
    for (const std::string& what : left_out_of(header_)) mesh_.warn(what);
    if (source_.has_extra_values())
      mesh_.warn("values at the end of a line that the header doesn't know are left out");
    if (!at_end) mesh_.warn("more data after the last element of the header are left out");
    return mesh_.finish(file_);
  }

 private:
  [[nodiscard]] Error header_error(const Element& element, const std::string& what) const {
    return element_error(element, file_, what);
  }

  std::uint32_t vertex_count() const {
    for (const Element& element : header_.elements) {
      if (element.name != "vertex") continue;
      if (element.count >= kMostVertices) throw header_error(element, "has more than 2^32 rows");
      return static_cast<std::uint32_t>(element.count);
    }
    return 0;
  }

  // A count in the header is believed only as far as the file has bytes for it.
  void check_capacity(const Element& element) const {
    if (element.count > source_.capacity() / Source::least_size(element)) {
      throw header_error(element, "says " + std::to_string(element.count) +
                                      " rows, for which the file is too short; fetch it again");
    }
  }

  void read_element(const Element& element) {
    if (element.name == "vertex") return read_vertices(element);
    if (element.name == "face") return read_lists(element, &Mesh::add_face);
    if (element.name == "tristrips") return read_lists(element, &Mesh::add_strip);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      source_.begin_row(element, row);
      for (const Property& p : element.properties) skip(p);
    }
  }

  void skip(const Property& p) {
    std::uint64_t n = p.is_list ? source_.list_length(p.count_type, p.type) : 1;
    while (n-- > 0) source_.skip(p.type);
  }

  void read_vertices(const Element& element) {
    const VertexColumns columns = find_columns(element, file_);
    auto& vertices = mesh_.vertices();
    auto& normals = mesh_.normals();
    vertices.resize(element.count);
    auto& colors = mesh_.colors();
    if (columns.has_normals) normals.resize(element.count);
    if (columns.has_colors) colors.assign(element.count, {0, 0, 0, static_cast<float>(columns.color_unit)});
    mesh_.set_color_unit(columns.color_unit);
    if constexpr (Source::kBinary) {
      if (!element.has_lists()) return read_columns(source_, element, columns, vertices, normals, colors);
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      source_.begin_row(element, row);
      std::array<double, 10> value{};
      value[9] = columns.color_unit;
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const int column = columns.of_property[i];
        if (column < 0) {
          skip(element.properties[i]);
        } else {
          value[static_cast<std::size_t>(column)] = source_.number(element.properties[i].type);
        }
      }
      vertices[row] = {value[0], value[1], value[2]};
      if (columns.has_normals) normals[row] = {value[3], value[4], value[5]};
      if (columns.has_colors)
        for (std::size_t c = 0; c < 4; ++c) colors[row][c] = static_cast<float>(value[6 + c]);
    }
  }

  // Rows of which one list names the corners of a face or a strip.
  void read_lists(const Element& element, bool (Mesh::*add)(std::span<const std::int64_t>)) {
    const Property* indices = element.find("vertex_indices");
    if (!indices) indices = element.find("vertex_index");
    if (!indices || !indices->is_list) throw header_error(element, "has no list 'vertex_indices'");
    if (!is_integer(indices->type)) throw header_error(element, "has 'vertex_indices' of no integer type");
    std::uint64_t row = 0;
    if constexpr (Source::kBinary) {
      if (element.name == "face") row = read_triangles(source_, element, mesh_);
    }
    if (element.name == "face") {
      constexpr std::uint64_t kLeastValues = 4;  // of a face that makes a triangle
      auto& triangles = mesh_.triangles();
      triangles.reserve(triangles.size() + std::min(element.count - row, source_.capacity() / kLeastValues));
    }
    std::vector<std::int64_t> corners;
    for (; row < element.count; ++row) {
      source_.begin_row(element, row);
      for (const Property& p : element.properties) {
        if (&p != indices) {
          skip(p);
          continue;
        }
        corners.resize(source_.list_length(p.count_type, p.type));
        for (std::int64_t& c : corners) c = source_.integer(p.type);
        if (!(mesh_.*add)(corners)) throw bad_corner(corners);
      }
    }
  }

  [[nodiscard]] Error bad_corner(const std::vector<std::int64_t>& corners) const {
    std::string bad;
    for (const std::int64_t c : corners) {
      if (c < 0 || c >= mesh_.n_vertices()) bad = std::to_string(c);
    }
    return source_.error("there is no vertex " + bad + " (the file has " +
                         std::to_string(mesh_.n_vertices()) + ")");
  }

  const Header& header_;
  Source& source_;
  const std::string& file_;
  Mesh mesh_;
};

template <class Source>
Scene read_body(std::string_view text, const Header& header, const std::string& file) {
  Source source(text, header, file);
  return BodyReader<Source>(header, source, file).read();
}

}  // namespace
}  // namespace ply

Scene read_ply(std::string_view text, const std::filesystem::path& path) {
  const std::string file = path.string();
  const ply::Header header = ply::read_header(text, file);
  switch (header.format) {
    case ply::Format::ascii:
      return ply::read_body<ply::AsciiSource>(text, header, file);
    case ply::Format::little_endian:
      return ply::read_body<ply::BinarySource<!ply::kLittleEndianHost>>(text, header, file);
    case ply::Format::big_endian:
      break;
  }
  return ply::read_body<ply::BinarySource<ply::kLittleEndianHost>>(text, header, file);
}

}  // namespace kdray::scene
