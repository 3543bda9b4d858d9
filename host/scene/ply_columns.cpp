#include "scene/ply_columns.h"

#include <array>
#include <string_view>

namespace kdray::scene::ply {

namespace {

double largest_color(Type type) {
  if (!is_integer(type)) return 1;
  return size_of(type) == 1 ? 255 : size_of(type) == 2 ? 65535 : 4294967295.0;
}

// red, green and blue of one type, and alpha if it has the same; also as diffuse_red and so on.
void find_colors(const Element& element, VertexColumns& columns) {
  for (const std::string prefix : {"", "diffuse_"}) {
    std::array<const Property*, 4> found{};
    constexpr std::array<std::string_view, 4> kParts = {"red", "green", "blue", "alpha"};
    for (std::size_t c = 0; c < 4; ++c) {
      found[c] = element.find(prefix + std::string(kParts[c]));
      if (c == 3 && !found[c]) found[c] = element.find("alpha");
      if (found[c] && (found[c]->is_list || (found[0] && found[c]->type != found[0]->type)))
        found[c] = nullptr;
    }
    if (!found[0] || !found[1] || !found[2]) continue;
    columns.has_colors = true;
    columns.color_unit = largest_color(found[0]->type);
    for (std::size_t c = 0; c < 4; ++c)
      if (found[c])
        columns.of_property[static_cast<std::size_t>(found[c] - element.properties.data())] =
            static_cast<int>(6 + c);
    return;
  }
}

}  // namespace

VertexColumns find_columns(const Element& element, const std::string& file) {
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
  find_colors(element, columns);
  return columns;
}

Error element_error(const Element& element, const std::string& file, const std::string& what) {
  return input_error(file, element.line, "element '" + element.name + "' " + what);
}

}  // namespace kdray::scene::ply
