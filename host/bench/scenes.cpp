#include "bench/scenes.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "base/error.h"
#include "bench/meshes.h"
#include "generate/generate.h"
#include "scene/frame.h"
#include "scene/importers.h"
#include "scene/load.h"

namespace kdray::bench {

namespace {

constexpr std::size_t kDisplaced = 1000000;  // triangles

scene::Scene displaced() {
  scene::Scene made = displaced_sphere_of(kDisplaced);
  made.name = "displaced";
  scene::frame_scene(made);
  return made;
}

[[noreturn]] void fail_unknown(const std::string& name) {
  std::string known = "boxes spheres displaced lamps";
  for (const generate::Generator& g : generate::generators()) known.append(" ").append(g.name);
  throw input_error(name, 0, "neither a file nor a built-in scene", "built in are " + known);
}

bool is_built_in(const std::string& name) {
  return name == "boxes" || name == "spheres" || name == "lamps" || name == "displaced" ||
         std::ranges::any_of(generate::generators(),
                             [&](const generate::Generator& g) { return g.name == name; });
}

}  // namespace

void require_scene(const std::string& name_or_file) {
  if (!is_built_in(name_or_file) && !std::filesystem::exists(name_or_file)) fail_unknown(name_or_file);
}

scene::Scene load_scene(const std::string& name_or_file) {
  if (name_or_file == "boxes") return boxes();
  if (name_or_file == "spheres") return spheres();
  if (name_or_file == "lamps") return lamps();
  if (name_or_file == "displaced") return displaced();
  for (const generate::Generator& g : generate::generators()) {
    if (g.name != name_or_file) continue;
    std::ostringstream text;
    generate::generate(g.name, g.default_size, text);
    scene::Scene made = scene::read_nff(text.str(), name_or_file + ".nff");
    made.name = name_or_file;
    scene::frame_scene(made);
    return made;
  }
  require_scene(name_or_file);
  return scene::load(name_or_file);
}

}  // namespace kdray::bench
