#include "scene/import/materials.h"

#include <bit>

namespace kdray::scene {

namespace {

void mix(std::uint64_t& hash, float value) {
  // -0 and 0 are equal materials, so they need equal hashes: adding 0 turns -0 into 0.
  hash ^= std::bit_cast<std::uint32_t>(value + 0.0f);
  hash *= 0x100000001b3u;
  hash ^= hash >> 29;
}

void mix(std::uint64_t& hash, const vec3& v) {
  mix(hash, v.x);
  mix(hash, v.y);
  mix(hash, v.z);
}

}  // namespace

std::size_t MaterialHash::operator()(const Material& m) const {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const vec3* v : {&m.emission, &m.ambient, &m.diffuse, &m.specular, &m.reflect, &m.transmit}) {
    mix(hash, *v);
  }
  mix(hash, m.shine);
  mix(hash, m.index);
  hash = (hash ^ m.maps) * 0x100000001b3u;
  return static_cast<std::size_t>(hash);
}

MaterialTable::MaterialTable(std::vector<Material>& materials) : materials_(materials) {
  for (std::uint32_t i = 0; i < materials_.size(); ++i) numbers_.emplace(materials_[i], i);
}

std::uint32_t MaterialTable::add(const Material& m) {
  const auto [entry, is_new] = numbers_.emplace(m, static_cast<std::uint32_t>(materials_.size()));
  if (is_new) materials_.push_back(m);
  return entry->second;
}

}  // namespace kdray::scene
