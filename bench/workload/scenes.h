// What    The scenes that benches know by name: those of scene/generate, "meadow", displaced
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

// Plants on uneven ground, seen by somebody who stands among them: meshes of a tuft of grass, a shrub and a
// tree, each seen many times as an instance that is turned and scaled. The ground is the scene's own.
scene::Scene meadow();

// What instances are measured on: the triangles of `mesh`, with one material, across * across times. Their
// middles lie on a grid, `apart` times the mesh's largest extent from each other: at 1 they stand side by
// side, at less they reach into each other. Each is turned about the vertical, and every second one mirrored.
// Camera and lights are those that a scene without them gets (scene/model/frame.h).
// Errors: ErrorCode::input for a scene without triangles.
scene::Scene flock_of(const scene::Scene& mesh, int across, double apart);

}  // namespace kdray::bench
