#include "scene/generate/built_in.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/generate/generate.h"
#include "scene/import/importers.h"
#include "scene/import/load.h"
#include "scene/model/frame.h"

namespace kdray::generate {

namespace {

constexpr std::size_t kDisplaced = 1000000;  // triangles

scene::Scene displaced() {
  scene::Scene made = displaced_sphere_of(kDisplaced);
  made.name = "displaced";
  scene::frame_scene(made);
  return made;
}

scene::Scene generated(const Generator& g) {
  std::ostringstream text;
  generate(g.name, g.default_size, text);
  scene::Scene made = scene::read_nff(text.str(), std::string(g.name) + ".nff");
  made.name = g.name;
  scene::frame_scene(made);
  return made;
}

struct BuiltIn {
  std::string name;
  std::function<scene::Scene()> make;
};

const std::vector<BuiltIn>& all_built_in() {
  static const std::vector<BuiltIn> all = [] {
    std::vector<BuiltIn> made = {
        {"boxes", boxes}, {"spheres", spheres}, {"displaced", displaced}, {"lamps", lamps}};
    for (const Generator& g : generators())
      made.push_back({std::string(g.name), [&g] { return generated(g); }});
    return made;
  }();
  return all;
}

// Null where none has that name.
const BuiltIn* find_built_in(const std::string& name) {
  const auto found = std::ranges::find(all_built_in(), name, &BuiltIn::name);
  return found == all_built_in().end() ? nullptr : &*found;
}

}  // namespace

void require_scene(const std::string& name_or_file) {
  if (find_built_in(name_or_file) || std::filesystem::exists(name_or_file)) return;
  std::string known;
  for (const BuiltIn& b : all_built_in()) known.append(known.empty() ? "" : " ").append(b.name);
  throw input_error(name_or_file, 0, "neither a file nor a built-in scene", "built in are " + known);
}

scene::Scene load_scene(const std::string& name_or_file) {
  if (const BuiltIn* const b = find_built_in(name_or_file)) return b->make();
  require_scene(name_or_file);
  return scene::load(name_or_file);
}

}  // namespace kdray::generate
