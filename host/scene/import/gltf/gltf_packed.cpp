#include "scene/import/gltf/gltf_packed.h"

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "scene/model/scene.h"

#ifdef KDRAY_WITH_DRACO
#include "scene/import/gltf/draco_stream.h"
#endif
#ifdef KDRAY_WITH_MESHOPT
#include <meshoptimizer.h>
#endif

namespace kdray::scene::gltf {

// ---- Draco

namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";

#ifdef KDRAY_WITH_DRACO
std::size_t parts_of(const JsonNode& accessor) {
  const JsonNode type = accessor["type"];
  const std::string name = type.string();
  if (name == "SCALAR") return 1;
  if (name.size() == 4 && name.starts_with("VEC") && name[3] >= '2' && name[3] <= '4')
    return static_cast<std::size_t>(name[3] - '0');
  throw type.expected("SCALAR, VEC2, VEC3 or VEC4");
}

std::uint32_t component_of_packed(const JsonNode& accessor) {
  const JsonNode node = accessor["componentType"];
  const std::uint64_t code = whole(node);
  if (!draco_stream::knows_component(code))
    throw node.expected("a component type (5120 to 5123, 5125 or 5126)");
  return static_cast<std::uint32_t>(code);
}

class Unpacking {
 public:
  Unpacking(Document& document, const JsonNode& primitive, const JsonNode& packed)
      : document_(document), primitive_(primitive), packed_(packed) {}

  void run() {
    const auto indices = primitive_.find("indices");
    if (!indices) throw primitive_.error("is packed, but has no indices", "export the file again");
    const std::string_view bytes =
        document_.view_bytes(document_.entry("bufferViews", packed_["bufferView"]));
    mesh_ = std::make_unique<draco_stream::Mesh>(bytes, packed_);
    count(mesh_->face_count(), 12);
    document_.put(document_.entry("accessors", *indices),
                  {mesh_->corners(), 3 * mesh_->face_count(), draco_stream::kUnsigned});
    for (const auto& [name, id] : packed_["attributes"].members()) put_attribute(name, id);
  }

 private:
  void count(std::uint64_t n, std::uint64_t bytes) { document_.count_unpacked(n * bytes, packed_); }

  void put_attribute(const std::string& name, const JsonNode& id) {
    const auto index = primitive_["attributes"].find(name);
    if (!index) throw id.error("the primitive has no such attribute");
    const JsonNode& accessor = document_.entry("accessors", *index);
    const std::uint64_t said = whole(accessor["count"]), there = mesh_->point_count();
    if (said != there)
      throw accessor.error("says " + std::to_string(said) + " elements, but its Draco stream has " +
                           std::to_string(there));
    const std::size_t parts = parts_of(accessor);
    const std::uint32_t component = component_of_packed(accessor);
    count(there, 4 * parts);
    document_.put(accessor, {mesh_->attribute(whole(id), parts, component, id), there, component});
  }

  Document& document_;
  const JsonNode& primitive_;
  const JsonNode& packed_;
  std::unique_ptr<draco_stream::Mesh> mesh_;
};
#else
// Returns whether the numbers are there unpacked too, as the file promises where it doesn't require the
// extension.
bool has_copy(Document& document, const JsonNode& primitive) {
  const auto is_there = [&](const JsonNode& index) {
    return document.entry("accessors", index).find("bufferView").has_value();
  };
  const auto members = primitive["attributes"].members();
  const auto indices = primitive.find("indices");
  return (!indices || is_there(*indices)) &&
         std::ranges::all_of(members, [&](const auto& member) { return is_there(member.second); });
}
#endif

}  // namespace

bool has_draco() {
#ifdef KDRAY_WITH_DRACO
  return true;
#else
  return false;
#endif
}

DracoMesh::DracoMesh(Document& document, const JsonNode& primitive) : document_(document) {
  const auto packed = extension(primitive, kExtension);
  if (!packed) return;
#ifdef KDRAY_WITH_DRACO
  Unpacking(document, primitive, *packed).run();
  is_there_ = true;
#else
  if (has_copy(document, primitive)) return;
  throw packed->error("the mesh is packed with Draco, which this kdray was built without",
                      "build it with libdraco-dev installed, or export the file without mesh compression");
#endif
}

DracoMesh::~DracoMesh() {
  document_.forget_unpacked();
}

// ---- meshopt

namespace {

// One byte of packed attributes can stand for 64 that are as predicted; indices take a byte for each
// triangle.
constexpr std::uint64_t kMostUnpackedBytes = 64;

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
  if (length / kMostUnpackedBytes > packed_size)
    throw packed.error("is damaged: " + std::to_string(packed_size) + " packed bytes can't hold " +
                       std::to_string(length));
  return length;
}

std::string unpack_meshopt(const JsonNode& packed, std::string_view bytes) {
#ifdef KDRAY_WITH_MESHOPT
  const Layout l = layout_of(packed);
  std::string out(l.count * l.stride, '\0');
  // libmeshoptimizer returns -1 for another codec, or another version of one, and other numbers for a stream
  // that is cut short.
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
