#include "scene/ply_left_out.h"

#include <algorithm>
#include <array>

#include "scene/text_scanner.h"

namespace kdray::scene::ply {

namespace {

constexpr std::size_t kMostNames = 6;  // in a line

bool is_read(const Element& element, std::string_view property) {
  constexpr std::array<std::string_view, 14> kOfVertices = {"x",
                                                            "y",
                                                            "z",
                                                            "nx",
                                                            "ny",
                                                            "nz",
                                                            "red",
                                                            "green",
                                                            "blue",
                                                            "alpha",
                                                            "diffuse_red",
                                                            "diffuse_green",
                                                            "diffuse_blue",
                                                            "diffuse_alpha"};
  if (element.name == "vertex") return std::ranges::find(kOfVertices, property) != kOfVertices.end();
  return property == "vertex_indices" || property == "vertex_index";
}

}  // namespace

std::vector<std::string> left_out_of(const Header& header) {
  std::vector<std::string> out;
  for (const Element& element : header.elements) {
    if (element.count == 0) continue;
    if (element.name != "vertex" && element.name != "face" && element.name != "tristrips") {
      out.push_back(std::to_string(element.count) + " rows of element '" + printable(element.name) +
                    "' are left out");
      continue;
    }
    std::size_t n = 0;
    std::string names;
    for (const Property& p : element.properties) {
      if (is_read(element, p.name)) continue;
      if (++n <= kMostNames) names += (n == 1 ? "" : ", ") + printable(p.name);
    }
    if (n > 0)
      out.push_back(std::to_string(n) + (n == 1 ? " property" : " properties") + " of '" + element.name +
                    (n == 1 ? "' is" : "' are") + " left out: " + names + (n > kMostNames ? ", ..." : ""));
  }
  return out;
}

}  // namespace kdray::scene::ply
