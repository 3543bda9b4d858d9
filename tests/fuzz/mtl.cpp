#include "scene/import/obj/mtl.h"
#include "fuzz/target.h"
#include "scene/model/check_scene.h"

KDRAY_FUZZ(mtl, bytes) {
  using namespace kdray;
  return fuzz::is_read([&] {
    std::vector<scene::MtlMaterial> materials;
    std::vector<std::string> warnings;
    scene::read_mtl(bytes, "a.mtl", materials, warnings);
    for (const scene::MtlMaterial& mtl : materials)
      for (const bool has_picture : {false, true})
        if (const char* const fault = scene::fault_of(scene::whitted_from_mtl(mtl, has_picture)))
          fuzz::fail(std::string("a material of an MTL: ") + fault);
  });
}
