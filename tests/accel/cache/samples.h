// What    Prepared scenes for the cache's tests, and what tells two of them apart.
#pragma once

#include <sstream>
#include <string>

#include "accel/cache/entry.h"
#include "accel/prepare/prepared.h"
#include "scene/generate/generate.h"
#include "scene/import/load.h"
#include "support/folder.h"

namespace kdray::test {

inline std::string nff(const std::string& name, int size) {
  std::ostringstream text;
  generate::generate(name, size, text);
  return text.str();
}

inline prepare::Prepared prepared_from(const std::filesystem::path& file, const TreeOptions& tree = {},
                                       const LoadOptions& load = {}) {
  return prepare::prepare(scene::load(file, load), tree);
}

// Everything is kept, however fast it was made.
inline CacheOptions all_kept_in(const std::filesystem::path& folder) {
  return {.folder = folder, .max_bytes = std::uint64_t{1} << 30, .min_bytes = 0};
}

template <class Values>
std::string bytes_of_values(const Values& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(*values.data())};
}

// Everything that a renderer reads of it, byte for byte; the list of its files is not among that.
inline std::string everything(const prepare::Prepared& p) {
  prepare::Prepared bare = p;
  bare.settings.files.clear();
  std::string all = cache::to_bytes(bare);
  for (const scene::Material& m : p.settings.materials) all += bytes_of_values(std::span(&m, 1));
  for (const scene::Light& l : p.settings.lights)
    all += bytes_of_values(std::span(&l.position, 1)) + bytes_of_values(std::span(&l.color, 1)) +
           std::to_string(static_cast<int>(l.kind)) + std::to_string(l.range) + std::to_string(l.cos_outer);
  const auto add = [&](const auto& array) { all += bytes_of_values(array); };
  flatten::for_each_flat_array(p.flat, add);
  flatten::for_each_wide_array(p.wide, add);
  return all;
}

}  // namespace kdray::test
