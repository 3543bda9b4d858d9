// What    PLY: polygons (element face) and triangle strips (element tristrips) over the element vertex, with
//         vertex normals, colours of vertices or faces, and pictures by texture coordinates of either; ascii
//         and binary, either byte order. Other elements and properties are skipped.
// Errors  ascii: file and line; binary: file, element, row and byte.
// Source  G. Turk, "The PLY Polygon File Format", 1994. Tristrips as the Stanford scanning repository writes
//         them.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/load.h"
#include "scene/import/materials.h"
#include "scene/import/ply/ply_header.h"
#include "scene/import/ply/ply_mesh.h"
#include "scene/import/ply/ply_source.h"
#include "scene/import/text_scanner.h"
#include "scene/model/scene.h"
#include "scene/textures/picture.h"

namespace kdray::scene::ply {

// ---- Pictures, as MeshLab and programs of photogrammetry name them: `comment TextureFile NAME`, which faces
// choose among by `texnumber`. A picture that is missing or damaged is left out, with a warning.

namespace {

// Finds a picture by its name, or by its last part beside the scene: programs write the paths of their own
// machine.
std::filesystem::path find_picture(const std::string& name, const std::filesystem::path& folder) {
  const std::filesystem::path path = std::filesystem::path(slashed(name)).lexically_normal();
  std::filesystem::path found;
  if (may_name(folder, path)) found = find_file(folder / path);
  return found.empty() && path.has_filename() ? find_file(folder / path.filename()) : found;
}

std::optional<std::uint32_t> picture_of(Scene& scene, const std::string& name, const std::string& file) {
  const std::filesystem::path path = find_picture(name, std::filesystem::path(file).parent_path());
  try {
    if (path.empty())
      throw input_error(file, 0, "no picture '" + printable(name) + "'",
                        std::string("put it beside the scene; ") + kAllowAFolder);
    return scene.texturing.add(decode_picture(read_file(path), path.string(), scene.warnings));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    scene.warnings.push_back(std::string(error.what()) + " (the picture is left out)");
    return std::nullopt;
  }
}

// Returns the material of meshes without pictures, with the picture as its base colour.
Material textured(Scene& scene, std::uint32_t picture) {
  MaterialMaps maps;
  Material m = colored_mesh_material(maps);
  maps.base = scene.texturing.add(Texture{.picture = picture, .minify = Minify::linear_mipmap_linear});
  maps.colored = !scene.texturing.colors.empty();
  m.maps = scene.texturing.add(maps);
  return m;
}

// Gives the scene, whose triangles have the number of their picture for a material, a material for each.
void lay_on_textures(Scene& scene, const Header& header, const std::string& file) {
  if (header.textures.empty()) return;
  const bool numbered =
      std::ranges::any_of(scene.triangles, [](const Triangle& t) { return t.material > 0; });
  const std::size_t n = numbered ? header.textures.size() : 1;
  if (header.textures.size() > n)
    scene.warnings.push_back(file + ": " + std::to_string(header.textures.size() - n) +
                             " further pictures are left out: no face has their texnumber");
  if (scene.texturing.texcoords[0].empty()) {
    scene.warnings.push_back(file + ": its picture '" + printable(header.textures[0]) +
                             "' is left out: there are no texture coordinates");
    for (Triangle& t : scene.triangles) t.material = 0;
    return;
  }
  const Material plain = scene.materials[0];
  scene.materials.assign(n, plain);
  for (std::size_t i = 0; i < n; ++i)
    if (const auto picture = picture_of(scene, header.textures[i], file))
      scene.materials[i] = textured(scene, *picture);
}

}  // namespace

}  // namespace kdray::scene::ply

namespace kdray::scene {

// ---- The file

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
    for (const std::string& what : left_out_of(header_, file_)) mesh_.warn(what);
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
    if (element.name == "face") return read_faces(element);
    if (element.name == "tristrips") return read_strips(element);
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
    const VertexColumns columns = find_columns(header_, element, file_);
    VertexArrays& out = mesh_.vertices();
    out.places.resize(element.count);
    if (columns.has_normals) out.normals.resize(element.count);
    if (columns.has_colors) {
      out.colors.assign(element.count, {0, 0, 0, static_cast<float>(columns.color_unit)});
      mesh_.set_color_unit(columns.color_unit);
    }
    if (columns.has_texcoords) out.texcoords.resize(element.count);
    if constexpr (Source::kBinary) {
      if (!element.has_lists()) return void(read_columns(source_, element, columns, out));
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      source_.begin_row(element, row);
      std::array<double, kColumns> value{};
      value[9] = columns.color_unit;
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const int column = columns.of_property[i];
        if (column < 0) {
          skip(element.properties[i]);
        } else {
          value[static_cast<std::size_t>(column)] = source_.number(element.properties[i].type);
        }
      }
      const auto narrow = [&](std::size_t i) { return static_cast<float>(value[i]); };
      out.places[row] = {value[0], value[1], value[2]};
      if (columns.has_normals) out.normals[row] = {value[3], value[4], value[5]};
      if (columns.has_colors) out.colors[row] = {narrow(6), narrow(7), narrow(8), narrow(9)};
      if (columns.has_texcoords) out.texcoords[row] = {narrow(10), narrow(11)};
    }
  }

  const Property& corners_of(const Element& element) const {
    const Property* indices = element.find("vertex_indices");
    if (!indices) indices = element.find("vertex_index");
    if (!indices || !indices->is_list) throw header_error(element, "has no list 'vertex_indices'");
    if (!is_integer(indices->type)) throw header_error(element, "has 'vertex_indices' of no integer type");
    return *indices;
  }

  void read_corners(const Property& p) {
    corners_.resize(source_.list_length(p.count_type, p.type));
    for (std::int64_t& c : corners_) c = source_.integer(p.type);
  }

  void read_strips(const Element& element) {
    const Property& indices = corners_of(element);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      source_.begin_row(element, row);
      for (const Property& p : element.properties) {
        if (&p != &indices) {
          skip(p);
          continue;
        }
        read_corners(p);
        if (!mesh_.add_strip(corners_)) throw bad_corner(corners_);
      }
    }
  }

  void read_faces(const Element& element) {
    const Property& indices = corners_of(element);
    const FaceColumns columns = find_face_columns(header_, element);
    if (columns.color[0]) mesh_.set_color_unit(columns.color_unit);
    std::uint64_t row = 0;
    if constexpr (Source::kBinary) row = read_triangles(source_, element, mesh_);
    constexpr std::uint64_t kLeastValues = 4;  // of a face that makes a triangle
    auto& triangles = mesh_.triangles();
    triangles.reserve(triangles.size() + std::min(element.count - row, source_.capacity() / kLeastValues));
    for (; row < element.count; ++row) {
      source_.begin_row(element, row);
      read_face(element, indices, columns);
    }
    if (n_odd_texcoords_ > 0)
      mesh_.warn("the texture coordinates of " + std::to_string(n_odd_texcoords_) +
                 " faces are not two for each corner: they are left out");
    if (n_odd_textures_ > 0)
      mesh_.warn("the texnumber of " + std::to_string(n_odd_textures_) +
                 " faces is that of no TextureFile: the first is taken");
  }

  void read_face(const Element& element, const Property& indices, const FaceColumns& columns) {
    VertexColor color{0, 0, 0, static_cast<float>(columns.color_unit)};
    std::int64_t texture = 0;
    texcoords_.clear();
    bool odd = false;
    for (const Property& p : element.properties) {
      const auto part = std::ranges::find(columns.color, &p) - columns.color.begin();
      if (&p == &indices) {
        read_corners(p);
      } else if (&p == columns.texcoords) {
        odd = !read_texcoords(p);
      } else if (&p == columns.texture) {
        texture = source_.integer(p.type);
      } else if (part < 4) {
        color[static_cast<std::size_t>(part)] = static_cast<float>(source_.number(p.type));
      } else {
        skip(p);
      }
    }
    if (odd || (!texcoords_.empty() && texcoords_.size() != corners_.size())) {
      ++n_odd_texcoords_;
      texcoords_.clear();
    }
    const std::size_t first = mesh_.triangles().size();
    if (!mesh_.add_face(corners_, texcoords_)) throw bad_corner(corners_);
    if (columns.color[0]) mesh_.color_face(first, color);
    if (!columns.texture) return;
    const bool known = texture >= 0 && static_cast<std::uint64_t>(texture) < header_.textures.size();
    n_odd_textures_ += !known;
    mesh_.set_texture(first, known ? static_cast<std::uint32_t>(texture) : 0);
  }

  // Returns false where a number is left over.
  bool read_texcoords(const Property& p) {
    const std::uint64_t n = source_.list_length(p.count_type, p.type);
    for (std::uint64_t i = 0; i < n; ++i) {
      const auto value = static_cast<float>(source_.number(p.type));
      if (i % 2 == 0) texcoords_.push_back({});
      texcoords_.back()[i % 2] = value;
    }
    return n % 2 == 0;
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
  std::vector<std::int64_t> corners_;  // of the row in work
  std::vector<TexCoord> texcoords_;
  std::size_t n_odd_texcoords_ = 0, n_odd_textures_ = 0;
};

template <class Source>
Scene read_body(std::string_view text, const Header& header, const std::string& file) {
  Source source(text, header, file);
  Scene scene = BodyReader<Source>(header, source, file).read();
  lay_on_textures(scene, header, file);
  return scene;
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
