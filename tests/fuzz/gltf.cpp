// glTF's texts and GLB, which its reader tells apart; at rest, and at a time of the animation.
#include "fuzz/scene_file.h"

KDRAY_FUZZ(gltf, bytes) {
  using kdray::fuzz::reads_scene;
  kdray::LoadOptions at_a_time;
  at_a_time.time = 0.3;
  reads_scene(bytes, "a.gltf", at_a_time);
  return reads_scene(bytes, "a.glb");
}
