#include "scene/import/gltf/gltf_meshopt.h"

#ifdef KDRAY_WITH_MESHOPT
#include <meshoptimizer.h>
#endif

namespace kdray::scene::gltf {

namespace {

// Of attributes, a byte tells of 64 that are as the prediction says; indices take a byte for each triangle.
constexpr std::uint64_t kMostPerByte = 64;

// What a stream is a sequence of.
struct Layout {
  std::uint64_t count = 0, stride = 0;
  std::string mode, filter;
};

Layout layout_of(const JsonNode& packed) {
  const auto filter = packed.find("filter");
  return {whole(packed["count"]), whole(packed["byteStride"]), packed["mode"].string(),
          filter ? filter->string() : "NONE"};
}

void check_stride(const JsonNode& packed, const Layout& l) {
  const bool attributes = l.mode == "ATTRIBUTES";
  if (!attributes && l.mode != "TRIANGLES" && l.mode != "INDICES")
    throw packed["mode"].expected("ATTRIBUTES, TRIANGLES or INDICES");
  const bool good =
      attributes ? l.stride > 0 && l.stride <= 256 && l.stride % 4 == 0 : l.stride == 2 || l.stride == 4;
  if (!good) throw packed["byteStride"].expected(attributes ? "a multiple of 4 up to 256" : "2 or 4");
  if (l.mode == "TRIANGLES" && l.count % 3 != 0) throw packed["count"].expected("a multiple of 3");
}

void check_filter(const JsonNode& packed, const Layout& l) {
  if (l.filter == "NONE") return;
  if (l.mode != "ATTRIBUTES") throw packed["filter"].error("indices have no filter");
  if (l.filter == "OCTAHEDRAL" && l.stride != 4 && l.stride != 8)
    throw packed["byteStride"].expected("4 or 8 for this filter");
  if (l.filter == "QUATERNION" && l.stride != 8) throw packed["byteStride"].expected("8 for this filter");
  if (l.filter == "OCTAHEDRAL" || l.filter == "QUATERNION" || l.filter == "EXPONENTIAL") return;
  throw packed["filter"].error("the filter " + l.filter + " is not read",
                               "pack the file with EXT_meshopt_compression");
}

#ifdef KDRAY_WITH_MESHOPT
int decode(const Layout& l, std::string_view bytes, std::string& out) {
  const auto* const from = reinterpret_cast<const unsigned char*>(bytes.data());
  if (l.mode == "ATTRIBUTES")
    return meshopt_decodeVertexBuffer(out.data(), l.count, l.stride, from, bytes.size());
  if (l.mode == "TRIANGLES")
    return meshopt_decodeIndexBuffer(out.data(), l.count, l.stride, from, bytes.size());
  return meshopt_decodeIndexSequence(out.data(), l.count, l.stride, from, bytes.size());
}

void apply_filter(const Layout& l, std::string& out) {
  if (l.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), l.count, l.stride);
  if (l.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), l.count, l.stride);
  if (l.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), l.count, l.stride);
}
#endif

}  // namespace

bool has_meshopt() {
#ifdef KDRAY_WITH_MESHOPT
  return true;
#else
  return false;
#endif
}

std::optional<JsonNode> meshopt_of(const JsonNode& view) {
  const auto first = extension(view, "EXT_meshopt_compression");
  return first ? first : extension(view, "KHR_meshopt_compression");
}

std::uint64_t meshopt_size(const JsonNode& view, const JsonNode& packed, std::uint64_t packed_size) {
  const Layout l = layout_of(packed);
  check_stride(packed, l);
  check_filter(packed, l);
  const std::uint64_t length = whole(view["byteLength"]);
  if (length % l.stride != 0 || length / l.stride != l.count)
    throw packed.error("its " + std::to_string(l.count) + " elements of " + std::to_string(l.stride) +
                       " bytes are not the " + std::to_string(length) + " bytes of its buffer view");
  if (length / kMostPerByte > packed_size)
    throw packed.error("is damaged: " + std::to_string(packed_size) + " packed bytes can't hold " +
                       std::to_string(length));
  return length;
}

std::string unpack_meshopt(const JsonNode& packed, std::string_view bytes) {
#ifdef KDRAY_WITH_MESHOPT
  const Layout l = layout_of(packed);
  std::string out(l.count * l.stride, '\0');
  // libmeshoptimizer says -1 of another codec, or another version of one, and other numbers of what is cut
  // short.
  const int fault = l.count == 0 ? 0 : decode(l, bytes, out);
  if (fault == -1)
    throw packed.error("its stream is of a codec that is not read",
                       "pack the file with EXT_meshopt_compression");
  if (fault != 0) throw packed.error("its stream is damaged", "export the file again");
  apply_filter(l, out);
  return out;
#else
  (void)bytes;
  throw no_meshopt(packed);
#endif
}

Error no_meshopt(const JsonNode& packed) {
  return packed.error(
      "is packed with meshopt compression, which this kdray was built without",
      "build it with libmeshoptimizer-dev installed, or export the file without mesh compression");
}

}  // namespace kdray::scene::gltf
