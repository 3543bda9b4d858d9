#include "fuzz/scene_file.h"

KDRAY_FUZZ(json, bytes) {
  return kdray::fuzz::reads_scene_of_two(bytes, "a.json");
}
