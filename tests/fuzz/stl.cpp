#include "fuzz/scene_file.h"

KDRAY_FUZZ(stl, bytes) {
  return kdray::fuzz::reads_scene(bytes, "a.stl");
}
