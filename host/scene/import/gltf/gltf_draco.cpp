#include "scene/import/gltf/gltf_draco.h"

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "scene/model/scene.h"
#ifdef KDRAY_WITH_DRACO
#include "scene/import/gltf/draco_stream.h"
#endif

namespace kdray::scene::gltf {

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
// The numbers are there, unpacked, as the file promises where it doesn't require the extension.
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

}  // namespace kdray::scene::gltf
