#include "scene/import/files_read.h"

#include <algorithm>
#include <string>
#include <utility>

namespace kdray::scene {

namespace {

thread_local FilesRead* recorder = nullptr;

}  // namespace

FilesRead::FilesRead() : outer_(std::exchange(recorder, this)) {}

FilesRead::~FilesRead() {
  recorder = outer_;
}

void FilesRead::add(const std::filesystem::path& path, std::string_view bytes) {
  if (recorder) recorder->files_.push_back({.path = path, .content = hash_of(bytes)});
}

void FilesRead::add_missing(const std::filesystem::path& path) {
  if (recorder) recorder->files_.push_back({.path = path, .content = std::nullopt});
}

void FilesRead::add_named(const std::filesystem::path& scene, std::string_view name) {
  if (!recorder || name.empty()) return;
  std::string slashed(name);
  std::ranges::replace(slashed, '\\', '/');
  const std::filesystem::path path(slashed), folder = scene.parent_path();
  recorder->files_.push_back({.path = folder / path, .content = std::nullopt, .only_named = true});
  if (path.has_parent_path())
    recorder->files_.push_back(
        {.path = folder / path.filename(), .content = std::nullopt, .only_named = true});
}

}  // namespace kdray::scene
