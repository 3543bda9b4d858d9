#include "scene/import/ply/ply_left_out.h"

#include "scene/import/ply/ply_columns.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene::ply {

namespace {

constexpr std::size_t kMostNames = 6;  // in a line

// By their places among the element's properties.
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

// What there is to see of points: nothing.
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
