// A meshopt stream by itself: how it is packed stands in the first bytes.
#include "scene/import/gltf/gltf_packed.h"

#include "fuzz/target.h"

KDRAY_FUZZ(meshopt, bytes) {
  using namespace kdray;
  constexpr const char* kModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
  constexpr const char* kFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  fuzz::Input input(bytes);
  const auto mode = input.take<std::uint8_t>(), filter = input.take<std::uint8_t>();
  const std::uint64_t stride = input.take<std::uint8_t>(), count = input.take<std::uint16_t>();
  const nlohmann::json packed = {
      {"count", count}, {"byteStride", stride}, {"mode", kModes[mode % 3]}, {"filter", kFilters[filter % 4]}};
  const nlohmann::json view = {{"byteLength", count * stride}};
  const std::string file = "a.gltf";
  const scene::JsonNode node(packed, file);
  return fuzz::is_read([&] {
    const std::uint64_t size =
        scene::gltf::meshopt_size(scene::JsonNode(view, file), node, input.rest().size());
    // A copy of its own: a read behind its end is seen.
    const std::string stream(input.rest());
    if (scene::gltf::unpack_meshopt(node, stream).size() != size) fuzz::fail("bytes of another number");
  });
}
