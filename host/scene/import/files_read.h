// What    Which files a scene was made of: all that were read while it was loaded, with a hash of each; those
//         that were looked for in vain, whose appearing would change the scene; and those that it only names
//         (pictures that nothing is made of). None of them may be overwritten by a run that loads the
//         scene.
// Shape   While a FilesRead lives, what its thread reads goes into it; they may be nested, and then the
//         innermost records.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "base/hash.h"

namespace kdray::scene {

struct FileRead {
  std::filesystem::path path;  // as it was opened
  // Of the file's own bytes, packed ones as they are; none: there was no such file.
  std::optional<Hash> content;
  bool only_named = false;  // never looked for: the scene is the same with and without it
  bool operator==(const FileRead&) const = default;
};

class FilesRead {
 public:
  FilesRead();
  ~FilesRead();
  FilesRead(const FilesRead&) = delete;
  FilesRead& operator=(const FilesRead&) = delete;

  std::vector<FileRead> take() { return std::move(files_); }

  // Called by whoever reads files, recorded or not.
  static void add(const std::filesystem::path& path, std::string_view bytes);
  static void add_missing(const std::filesystem::path& path);
  // `name` as it stands in the file `scene`. Exporters write backslashes and the paths of their own machines:
  // then it is the file of that name beside the scene, too.
  static void add_named(const std::filesystem::path& scene, std::string_view name);

 private:
  FilesRead* outer_;
  std::vector<FileRead> files_;
};

}  // namespace kdray::scene
