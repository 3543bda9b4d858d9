// What    The argument SCENE: a file, or "-" for a scene from standard input in the format that
//         --scene-format names.
// Errors  kdray::Error: ErrorCode::usage for a format that is missing or superfluous, else the reader's own.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::cli {

struct SceneInput {
  std::string file;
  std::string format;  // of standard input: the ending of such a file, "nff" or "ply"
  LoadOptions load;

  bool is_stdin() const { return file == "-"; }
};

// SCENE --scene-format, and the options of add_load_options()
void add_scene_input(CLI::App& app, SceneInput& input, const std::string& help);

// --smooth --time --animation --texture-memory --texture-cache --instances --asset-root
void add_load_options(CLI::App& app, LoadOptions& load);

// Throw where options don't go together; called before anything else is done with them.
void check_load_options(const LoadOptions& load);
void check_scene_input(const SceneInput& input);

// Return the scene with a camera and lights, as scene::load() and Scene::load() do.
scene::Scene load_model(const SceneInput& input);
Scene load_scene(const SceneInput& input);

}  // namespace kdray::cli
