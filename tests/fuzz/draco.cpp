// A Draco stream by itself, without the glTF around it, all of whose attributes are asked for.
#include "scene/import/gltf/draco_stream.h"

#include "fuzz/target.h"

KDRAY_FUZZ(draco, bytes) {
  using namespace kdray;
  const nlohmann::json nothing;
  const std::string file = "a.gltf";
  const scene::JsonNode where(nothing, file);
  return fuzz::is_read([&] {
    const scene::draco_stream::Mesh mesh(bytes, where);
    if (mesh.corners().size() != 12 * mesh.face_count()) fuzz::fail("corners that are not three to a face");
    constexpr std::uint32_t kFloat = 5126, kByte = 5121;
    for (std::uint64_t id = 0; id < 4; ++id)
      for (const std::uint32_t component : {kFloat, kByte})
        fuzz::is_read([&] { mesh.attribute(id, 3, component, where); });
  });
}
