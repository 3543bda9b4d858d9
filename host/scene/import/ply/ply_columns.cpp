#include "scene/import/ply/ply_header.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "scene/import/load.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene::ply {

namespace {

double largest_color(Type type) {
  if (!is_integer(type)) return 1;
  return size_of(type) == 1 ? 255 : size_of(type) == 2 ? 65535 : 4294967295.0;
}

using Colors = std::array<const Property*, 4>;

// Returns red, green and blue of one type, and alpha if it has the same, under the names that programs give
// them.
Colors find_colors(const Element& element) {
  constexpr std::array<std::array<std::string_view, 4>, 3> kNames = {
      {{"red", "green", "blue", "alpha"},
       {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"},
       {"r", "g", "b", "a"}}};
  for (const auto& names : kNames) {
    Colors found{};
    for (std::size_t c = 0; c < 4; ++c) {
      found[c] = element.find(names[c]);
      if (c == 3 && !found[c]) found[c] = element.find("alpha");
      if (found[c] && (found[c]->is_list || (found[0] && found[c]->type != found[0]->type)))
        found[c] = nullptr;
    }
    if (found[0] && found[1] && found[2]) return found;
  }
  return {};
}

bool wants_texcoords(const Header& header) {
  return !header.textures.empty() || keeps_texcoords();
}

// Returns the property that is a list of floats, u and v for each corner.
const Property* find_texcoords_of_faces(const Header& header) {
  if (!wants_texcoords(header)) return nullptr;
  for (const Element& element : header.elements) {
    if (element.name != "face") continue;
    const Property* const list = element.find("texcoord");
    return list && list->is_list && !is_integer(list->type) ? list : nullptr;
  }
  return nullptr;
}

std::array<const Property*, 2> find_texcoords(const Element& element) {
  constexpr std::array<std::array<std::string_view, 2>, 4> kNames = {
      {{"texture_u", "texture_v"}, {"s", "t"}, {"u", "v"}, {"texture_s", "texture_t"}}};
  for (const auto& [u, v] : kNames) {
    const std::array<const Property*, 2> found{element.find(u), element.find(v)};
    const auto is_number = [](const Property* p) { return p && !p->is_list; };
    if (is_number(found[0]) && is_number(found[1])) return found;
  }
  return {};
}

}  // namespace

VertexColumns find_columns(const Header& header, const Element& element, const std::string& file) {
  constexpr std::array<std::string_view, 6> kNames = {"x", "y", "z", "nx", "ny", "nz"};
  std::array<int, 6> place;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const Property* p = element.find(kNames[i]);
    place[i] = p && !p->is_list ? static_cast<int>(p - element.properties.data()) : -1;
    if (i < 3 && place[i] < 0)
      throw element_error(element, file, "has no property '" + std::string(kNames[i]) + "'");
  }
  VertexColumns columns;
  columns.of_property.assign(element.properties.size(), -1);
  columns.has_normals = place[3] >= 0 && place[4] >= 0 && place[5] >= 0;
  const std::size_t n = columns.has_normals ? 6 : 3;
  for (std::size_t i = 0; i < n; ++i)
    columns.of_property[static_cast<std::size_t>(place[i])] = static_cast<int>(i);
  const auto set = [&](const Property* p, std::size_t column) {
    if (p)
      columns.of_property[static_cast<std::size_t>(p - element.properties.data())] = static_cast<int>(column);
  };
  const Colors colors = find_colors(element);
  columns.has_colors = colors[0] != nullptr;
  if (columns.has_colors) columns.color_unit = largest_color(colors[0]->type);
  for (std::size_t c = 0; c < 4; ++c) set(colors[c], 6 + c);
  if (!wants_texcoords(header) || find_texcoords_of_faces(header)) return columns;
  const auto texcoords = find_texcoords(element);
  columns.has_texcoords = texcoords[0] != nullptr;
  for (std::size_t c = 0; c < 2; ++c) set(texcoords[c], 10 + c);
  return columns;
}

bool FaceColumns::reads(const Property& p) const {
  return &p == texcoords || &p == texture || std::ranges::find(color, &p) != color.end();
}

FaceColumns find_face_columns(const Header& header, const Element& element) {
  FaceColumns columns{.texcoords = find_texcoords_of_faces(header)};
  const auto vertices = std::ranges::find(header.elements, "vertex", &Element::name);
  const bool colored_vertices = vertices != header.elements.end() && find_colors(*vertices)[0];
  if (!colored_vertices) columns.color = find_colors(element);
  if (columns.color[0]) columns.color_unit = largest_color(columns.color[0]->type);
  const Property* const texture = element.find("texnumber");
  const bool counts = texture && !texture->is_list && is_integer(texture->type);
  if (counts && header.textures.size() > 1) columns.texture = texture;
  return columns;
}

Error element_error(const Element& element, const std::string& file, const std::string& what) {
  return input_error(file, element.line, "element '" + element.name + "' " + what);
}

namespace {

constexpr std::size_t kMostNames = 6;  // in a line

// Returns for each of the element's properties whether it is read.
std::vector<bool> read_properties(const Header& header, const Element& element, const std::string& file) {
  std::vector<bool> read(element.properties.size());
  const VertexColumns columns =
      element.name == "vertex" ? find_columns(header, element, file) : VertexColumns{};
  const FaceColumns of_face = element.name == "face" ? find_face_columns(header, element) : FaceColumns{};
  for (std::size_t i = 0; i < read.size(); ++i) {
    const Property& p = element.properties[i];
    const bool corners = p.name == "vertex_indices" || p.name == "vertex_index";
    read[i] = element.name == "vertex" ? columns.of_property[i] >= 0 : corners || of_face.reads(p);
  }
  return read;
}

// Says that points alone are not seen.
void tell_of_points(const Header& header, std::vector<std::string>& out) {
  const Element* points = nullptr;
  for (const Element& element : header.elements) {
    if ((element.name == "face" || element.name == "tristrips") && element.count > 0) return;
    if (element.name == "vertex" && element.count > 0) points = &element;
  }
  if (!points) return;
  const bool splats = points->find("f_dc_0") || (points->find("opacity") && points->find("scale_0"));
  out.push_back(std::string(splats ? "it holds Gaussian splats" : "it is a point cloud") +
                ": kdray shows surfaces; make a mesh of it first");
}

}  // namespace

std::vector<std::string> left_out_of(const Header& header, const std::string& file) {
  std::vector<std::string> out;
  tell_of_points(header, out);
  for (const Element& element : header.elements) {
    if (element.count == 0) continue;
    if (element.name != "vertex" && element.name != "face" && element.name != "tristrips") {
      out.push_back(std::to_string(element.count) + " rows of element '" + printable(element.name) +
                    "' are left out");
      continue;
    }
    std::size_t n = 0;
    std::string names;
    const std::vector<bool> read = read_properties(header, element, file);
    for (std::size_t i = 0; i < read.size(); ++i)
      if (!read[i] && ++n <= kMostNames)
        names += (n == 1 ? "" : ", ") + printable(element.properties[i].name);
    if (n > 0)
      out.push_back(std::to_string(n) + (n == 1 ? " property" : " properties") + " of '" + element.name +
                    (n == 1 ? "' is" : "' are") + " left out: " + names + (n > kMostNames ? ", ..." : ""));
  }
  return out;
}

}  // namespace kdray::scene::ply
