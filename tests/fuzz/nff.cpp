#include "fuzz/scene_file.h"

KDRAY_FUZZ(nff, bytes) {
  return kdray::fuzz::reads_scene(bytes, "a.nff");
}
