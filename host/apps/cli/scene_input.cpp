#include "apps/cli/scene_input.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "apps/cli/help.h"
#include "apps/cli/options.h"
#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/load.h"

namespace kdray::cli {

namespace {

// In the order of the enumeration's values.
constexpr std::array<std::string_view, 3> kInstances = {"auto", "flat", "kept"};

std::string bytes_of_stdin() {
  std::string bytes;
  char block[1 << 16];
  while (const std::size_t n = std::fread(block, 1, sizeof block, stdin)) {
    bytes.append(block, n);
    if (bytes.size() > scene::kMaxBytes)
      throw input_error("standard input", 0, "has more bytes than a scene may have", "split the scene");
  }
  if (std::ferror(stdin)) throw input_error("standard input", 0, "cannot be read to its end");
  return bytes;
}

// Returns the name that messages have for standard input. Its ending is the format, and a second ending says
// how the bytes are packed. The files that such a scene names are looked for in the current folder.
std::filesystem::path name_of(const SceneInput& input, std::string_view bytes) {
  std::string name = "stdin." + input.format;
  if (bytes.starts_with("\x1f\x8b")) name += ".gz";
  if (bytes.starts_with("\xfd"
                        "7zXZ"))
    name += ".xz";
  return name;
}

constexpr std::array kSceneOptions = {"--scene-format",   "--smooth",        "--time",      "--animation",
                                      "--texture-memory", "--texture-cache", "--instances", "--asset-root"};

}  // namespace

void add_scene_input(CLI::App& app, SceneInput& input, const std::string& help) {
  app.add_option("SCENE", input.file, help)->required()->type_name("");
  add_text(
      app, "--scene-format", "nff|obj|ply|stl|gltf|glb|json", "Format of a SCENE from standard input",
      [&input](const std::string& text) { input.format = text.starts_with('.') ? text.substr(1) : text; });
  add_load_options(app, input.load);
}

void add_load_options(CLI::App& app, LoadOptions& load) {
  add_text(app, "--smooth", "DEG",
           "Smooth shading for triangles without normals, where faces turn by no more than DEG (as in 40)",
           [&load](const std::string& text) { load.smooth_degrees = parse_real("--smooth", text, 0, 180); });
  add_text(app, "--time", "SECONDS",
           "The second of a glTF file's animation that is seen (default: it is at rest)",
           [&load](const std::string& text) { load.time = parse_real("--time", text, -1e9, 1e9); });
  add_text(app, "--animation", "NAME|all",
           "Which animation --time is of: a name or a number from 0 (default 0), or all at once",
           [&load](const std::string& text) {
             if (text.empty()) throw usage_error("--animation", text, "a name, a number or all");
             load.animation = text;
           });
  add_text(app, "--texture-memory", "BYTES",
           "The most that pictures on surfaces may take, as in 500M: larger ones are made smaller",
           [&load](const std::string& text) { load.texture_bytes = parse_bytes("--texture-memory", text); });
  add_text(
      app, "--texture-cache", "BYTES",
      "The most memory for pictures on surfaces, as in 2G; the rest is in files (default: half of what is "
      "free)",
      [](const std::string& text) { set_texture_cache(parse_bytes("--texture-cache", text)); });
  add_choice(app, "--instances",
             "What shows many times: auto (held once where copies would be over a million primitives), flat "
             "(copied) or kept (held once)",
             kInstances, load.instances);
  add_text(app, "--asset-root", "DIR",
           "A folder below which the scene may name pictures and buffers that are not beside it or below it",
           [&load](const std::string& text) { load.asset_root = text; });
  put_into_group(app, "Scene", kSceneOptions);
}

void check_load_options(const LoadOptions& load) {
  if (!load.animation.empty() && !load.time)
    throw Error(ErrorCode::usage, "--animation says which one is seen; say at which second with --time");
}

void check_scene_input(const SceneInput& input) {
  if (input.is_stdin() && input.format.empty())
    throw Error(ErrorCode::usage,
                "SCENE '-' is standard input; say its format, as in --scene-format nff (or obj, ply, stl, "
                "gltf, glb, json)");
  if (!input.is_stdin() && !input.format.empty())
    throw Error(
        ErrorCode::usage,
        "--scene-format is for a scene from standard input ('-'); a file's format is that of its name");
  check_load_options(input.load);
}

scene::Scene load_model(const SceneInput& input) {
  if (!input.is_stdin()) return scene::load(input.file, input.load);
  std::string bytes = bytes_of_stdin();
  const std::filesystem::path name = name_of(input, bytes);
  return scene::load_from_memory(std::move(bytes), name, input.load);
}

Scene load_scene(const SceneInput& input) {
  if (!input.is_stdin()) return Scene::load(input.file, input.load);
  std::string bytes = bytes_of_stdin();
  const std::filesystem::path name = name_of(input, bytes);
  return Scene::from_memory(std::move(bytes), name, input.load);
}

}  // namespace kdray::cli
