#include "scene/import/abilities.h"

namespace kdray::scene {

namespace {

#ifdef KDRAY_WITH_JPEG
constexpr bool kJpeg = true;
#else
constexpr bool kJpeg = false;
#endif
#ifdef KDRAY_WITH_WEBP
constexpr bool kWebp = true;
#else
constexpr bool kWebp = false;
#endif
#ifdef KDRAY_WITH_DRACO
constexpr bool kDraco = true;
#else
constexpr bool kDraco = false;
#endif
#ifdef KDRAY_WITH_MESHOPT
constexpr bool kMeshopt = true;
#else
constexpr bool kMeshopt = false;
#endif
#ifdef KDRAY_WITH_ASSIMP
constexpr bool kOtherMeshes = true;
#else
constexpr bool kOtherMeshes = false;
#endif

}  // namespace

const std::vector<Ability>& abilities() {
  static const std::vector<Ability> all = {
      {"JPEG pictures", "libturbojpeg0-dev", kJpeg},
      {"WebP pictures (glTF's EXT_texture_webp)", "libwebp-dev", kWebp},
      {"meshes packed with KHR_draco_mesh_compression", "libdraco-dev", kDraco},
      {"meshes packed with EXT_meshopt_compression", "libmeshoptimizer-dev", kMeshopt},
      {"3ds, dae, fbx, off, x3d and other meshes", "libassimp-dev", kOtherMeshes}};
  return all;
}

}  // namespace kdray::scene
