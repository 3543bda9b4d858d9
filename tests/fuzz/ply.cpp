#include "fuzz/scene_file.h"

KDRAY_FUZZ(ply, bytes) {
  return kdray::fuzz::reads_scene(bytes, "a.ply");
}
