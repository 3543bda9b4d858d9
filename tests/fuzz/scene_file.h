// What    Reads an input as a scene file of a name, as the command line does: the format's reader, the checks
//         of every scene, its framing, and the geometry that trees are made of.
// Shape   "picture.png" is beside it. Behind the first byte 0 of an OBJ or JSON, if any, is another file that
//         it may name, "other.mtl" or "other.ply".
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "fuzz/target.h"
#include "scene/import/load.h"
#include "scene/model/geometry.h"
#include "scene/pictures.h"

namespace kdray::fuzz {

// A folder with the files that an input may name, which are in memory.
class SceneFolder {
 public:
  SceneFolder()
      : path_(std::filesystem::temp_directory_path() / ("kdray-fuzz-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);  // of a process that has ended before its time
    std::filesystem::create_directories(path_);
    picture_.put(test::four_colors());
    std::filesystem::create_symlink(picture_.path(), path_ / "picture.png");
    for (const char* const name : {"other.mtl", "other.ply"})
      std::filesystem::create_symlink(other_.path(), path_ / name);
  }
  ~SceneFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  const std::filesystem::path& path() const { return path_; }
  void put_other(std::string_view bytes) const { other_.put(bytes); }

 private:
  std::filesystem::path path_;
  MemoryFile picture_, other_;
};

inline const SceneFolder& scene_folder() {
  static const SceneFolder folder;
  return folder;
}

inline bool reads_scene(std::string_view bytes, const char* name, const LoadOptions& options = {}) {
  const std::filesystem::path file = scene_folder().path() / name;
  return is_read([&] {
    const scene::Scene scene = scene::load_from_memory(std::string(bytes), file, options);
    scene::make_geometry(scene);
  });
}

inline bool reads_scene_of_two(std::string_view bytes, const char* name) {
  const std::size_t end = std::min(bytes.find('\0'), bytes.size());
  scene_folder().put_other(end < bytes.size() ? bytes.substr(end + 1) : std::string_view());
  return reads_scene(bytes.substr(0, end), name);
}

}  // namespace kdray::fuzz
