// Pictures, and materials that show them.
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include "arrays.h"
#include "interrupt.h"
#include "parts.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;
using namespace nb::literals;

// python/kdray/_pixels.py has seen to the type, and to it that only rows may lie apart.
Pixels pixels_of(const In::value_type& array) {
  if (array.ndim() != 3 || array.dtype() != nb::dtype<std::uint8_t>() || array.stride(2) != 1 ||
      array.stride(1) != static_cast<std::int64_t>(array.shape(2)) || array.stride(0) < 0)
    throw Error(ErrorCode::internal, "an array of this shape can't be seen as a picture");
  return {.data = static_cast<const std::uint8_t*>(array.data()),
          .width = static_cast<std::uint32_t>(array.shape(1)),
          .height = static_cast<std::uint32_t>(array.shape(0)),
          .channels = static_cast<std::uint32_t>(array.shape(2)),
          .row_bytes = static_cast<std::size_t>(array.stride(0))};
}

AlphaMode alpha_of(const std::string& name) {
  if (name == "opaque") return AlphaMode::opaque;
  if (name == "mask") return AlphaMode::mask;
  if (name == "blend") return AlphaMode::blend;
  throw Error(ErrorCode::usage, "alpha is \"opaque\", \"mask\" or \"blend\", not \"" + name + "\"");
}

}  // namespace

void add_textures(SceneClass& scene) {
  scene.def(
      "add_picture", [](Scene& s, const In::value_type& pixels) { return s.add_picture(pixels_of(pixels)); },
      Released(), "pixels"_a);
  scene.def(
      "add_picture_file", [](Scene& s, const std::string& file) { return s.add_picture(file); }, Released(),
      "file"_a);
  // `pictures`: the material's own, its normals', its emission's, metal's and occlusion's; kNoPicture: none.
  // `factors`: metallic, roughness, occlusion.
  scene.def("add_material", [](Scene& s, const Color& emission, const Color& ambient, const Color& diffuse,
                               const Color& specular, const Color& reflect, const Color& transmit,
                               float shine, float index, const std::array<PictureId, 5>& pictures,
                               const std::string& alpha, const std::array<float, 3>& factors) {
    return s.add_material({emission, ambient, diffuse, specular, reflect, transmit, shine, index, pictures[0],
                           pictures[1], pictures[2], alpha_of(alpha), pictures[3], factors[0], factors[1],
                           pictures[4], factors[2]});
  });
}

}  // namespace kdray::python
