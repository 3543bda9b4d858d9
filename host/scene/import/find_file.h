// What    Finds the files that a scene file names: pictures, materials, buffers.
// Shape   A name that no file has stands for the only one that differs from it in capitals alone, as on the
//         systems that many scenes come from. What a scene may name at all is what is beside it or below, and
//         what is below the asset root, a folder that the user allows.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kdray::scene {

// Returns the name with the slashes of all systems as '/'.
std::string slashed(std::string_view name);

// Returns the name without quotes around it.
std::string_view unquoted(std::string_view name);

// The file that the path stands for; empty: there is none, which is noted (files_read.h).
std::filesystem::path find_file(const std::filesystem::path& path);

// Whether a scene in `folder` may name this file: by its name beside it or below; or below the asset root,
// with links followed.
bool may_name(const std::filesystem::path& folder, const std::filesystem::path& name);

// What a message says about a name that may_name() refuses, and what to do about it.
std::string outside(std::string_view name);
inline constexpr const char* kAllowAFolder = "--asset-root DIR allows what is below DIR";

// While one lives, what is below the folder may be named by scenes that its thread reads; empty: nothing
// more.
class AssetRoot {
 public:
  explicit AssetRoot(std::filesystem::path folder);
  ~AssetRoot();
  AssetRoot(const AssetRoot&) = delete;
  AssetRoot& operator=(const AssetRoot&) = delete;

 private:
  std::filesystem::path outer_;
};

}  // namespace kdray::scene
