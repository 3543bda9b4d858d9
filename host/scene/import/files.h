// What    The files of a scene: finding them, reading them whole into memory (decompressed when a name ends
//         in .gz or .xz), and a record of all.
// Errors  read_file and unpacked: kdray::Error, ErrorCode::input: missing, a folder, unreadable, damaged, or
//         larger than `kMaxBytes` unpacked; a Git LFS pointer or a web page in place of the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/hash.h"

namespace kdray::scene {

// ---- Which files a scene was made of: all that were read while it was loaded, with a hash of each; those
// that were looked for in vain, whose appearing would change the scene; and those that it only names
// (pictures that nothing is made of). None of them may be overwritten by a run that loads the scene. While a
// FilesRead lives, what its thread reads goes into it; they may be nested, and then the innermost records.

struct FileRead {
  std::filesystem::path path;  // as it was opened
  // The hash of the file's bytes, packed ones as they are; none where there was no such file.
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

  // What reads files calls these, whether a FilesRead lives or not.
  static void add(const std::filesystem::path& path, std::string_view bytes);
  static void add_missing(const std::filesystem::path& path);
  // `name` as it stands in the file `scene`. Exporters write backslashes and the paths of their own machines:
  // then it is the file of that name beside the scene, too.
  static void add_named(const std::filesystem::path& scene, std::string_view name);

 private:
  FilesRead* outer_;
  std::vector<FileRead> files_;
};

// ---- Finding the files that a scene file names: a name that no file has stands for the only one that
// differs from it in capitals alone, as on the systems that many scenes come from. What a scene may name at
// all is what is beside it or below, and what is below the asset root, a folder that the user allows.

// Returns the name with the slashes of all systems as '/'.
std::string slashed(std::string_view name);

// Returns the name without quotes around it.
std::string_view unquoted(std::string_view name);

// Returns the file that the path stands for; empty where there is none, which FilesRead records.
std::filesystem::path find_file(const std::filesystem::path& path);

// Returns whether a scene in `folder` may name this file: by its name beside it or below; or below the asset
// root, with links followed.
bool may_name(const std::filesystem::path& folder, const std::filesystem::path& name);

// Returns the message about a name that may_name() refuses, and what to do about it.
std::string outside(std::string_view name);
inline constexpr const char* kAllowAFolder = "--asset-root DIR allows what is below DIR";

// While an AssetRoot lives, scenes that its thread reads may name what is below the folder; an empty one
// allows nothing more.
class AssetRoot {
 public:
  explicit AssetRoot(std::filesystem::path folder);
  ~AssetRoot();
  AssetRoot(const AssetRoot&) = delete;
  AssetRoot& operator=(const AssetRoot&) = delete;

 private:
  std::filesystem::path outer_;
};

// ---- Reading

inline constexpr std::size_t kMaxBytes = std::size_t{4} << 30;

std::string read_file(const std::filesystem::path& file, std::size_t max_bytes = kMaxBytes);

// Returns a file's bytes, decompressed as its name says.
std::string unpacked(std::string bytes, const std::filesystem::path& file, std::size_t max_bytes = kMaxBytes);

// Returns the ending that names the format, lower case, without ".gz"/".xz": "dragon.PLY.xz" -> ".ply".
std::string format_of(const std::filesystem::path& file);

}  // namespace kdray::scene
