// What    What this kdray can read by way of libraries that are optional when it is built, for users to see.
#pragma once

#include <vector>

namespace kdray::scene {

struct Ability {
  const char* what;     // "Draco-compressed meshes"
  const char* package;  // Debian's, which it takes to have it: "libdraco-dev"
  bool here;            // kdray was built with it
};

const std::vector<Ability>& abilities();

}  // namespace kdray::scene
