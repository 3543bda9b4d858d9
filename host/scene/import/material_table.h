// What    Gives equal materials one number, so that a file that repeats its materials (one `f` line per ball)
//         costs the device one entry.
// Shape   Numbers index the vector the table was made over; entries already in it are found too.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::scene {

struct MaterialHash {
  std::size_t operator()(const Material& m) const;
};

class MaterialTable {
 public:
  explicit MaterialTable(std::vector<Material>& materials);

  // The number of a material equal to `m`, adding it when there is none.
  std::uint32_t add(const Material& m);

 private:
  std::vector<Material>& materials_;
  std::unordered_map<Material, std::uint32_t, MaterialHash> numbers_;
};

}  // namespace kdray::scene
