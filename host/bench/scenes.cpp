#include "bench/scenes.h"

#include <algorithm>
#include <sstream>

#include "generate/generate.h"
#include "scene/frame.h"
#include "scene/importers.h"
#include "scene/load.h"

namespace kdray::bench {

scene::Scene load_scene(const std::string& name_or_file) {
  if (name_or_file == "boxes") return boxes();
  if (name_or_file == "spheres") return spheres();
  for (const generate::Generator& g : generate::generators()) {
    if (g.name != name_or_file) continue;
    std::ostringstream text;
    generate::generate(g.name, g.default_size, text);
    scene::Scene made = scene::read_nff(text.str(), name_or_file + ".nff");
    made.name = name_or_file;
    scene::frame_scene(made);
    return made;
  }
  return scene::load(name_or_file);
}

}  // namespace kdray::bench
