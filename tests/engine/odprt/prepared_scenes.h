// What    The scenes that the tests of a division are run on, prepared: empty, one primitive, all kinds, a
//         mesh.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "accel/prepare/prepared.h"
#include "pictures/scenes.h"

namespace kdray::test {

inline scene::Scene one_sphere() {
  scene::Scene s;
  s.materials.emplace_back();
  s.spheres.push_back({dvec3(0), 1, 0, 0});
  return s;
}

inline std::vector<std::pair<std::string, prepare::Prepared>> prepared_scenes() {
  std::vector<std::pair<std::string, prepare::Prepared>> all;
  all.emplace_back("empty", prepare::prepare(scene::Scene(), TreeOptions()));
  all.emplace_back("one sphere", prepare::prepare(one_sphere(), TreeOptions()));
  for (const NamedScene& s : small_scenes())
    all.emplace_back(s.name, prepare::prepare(s.make(), TreeOptions()));
  return all;
}

}  // namespace kdray::test
