#include "scene/files_read.h"

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
  if (recorder) recorder->files_.push_back({path, hash_of(bytes)});
}

void FilesRead::add_missing(const std::filesystem::path& path) {
  if (recorder) recorder->files_.push_back({path, std::nullopt});
}

}  // namespace kdray::scene
