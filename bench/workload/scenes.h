// What    The scenes that benches know by name: those of scene/generate, "meadow" (meadow.h), displaced
//         spheres of so many triangles ("displaced:50000"), and rooms and scans that people measure by, out
//         of the folder that the variable KDRAY_DATA names: Dabrovic's Sponza and the conference room, each
//         seen from within, armadillo and dragon.
// Errors  Those of scene::load; ErrorCode::input for a name that is none of these, or of data that aren't
//         there.
#pragma once

#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::bench {

scene::Scene load_scene(const std::string& name_or_file);

// Throws for what load_scene() doesn't know, so that a run over many scenes can refuse it before the first.
void require_scene(const std::string& name_or_file);

// Of the folder of data, the names whose files are there; and those whose files aren't.
struct DataNames {
  std::vector<std::string> here, missing;
};
DataNames data_scenes();

}  // namespace kdray::bench
