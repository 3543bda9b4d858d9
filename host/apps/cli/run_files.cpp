#include "apps/cli/run_files.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/write_file.h"

namespace fs = std::filesystem;

namespace kdray::cli {

RunFiles::Place::Place(const fs::path& file) {
  struct stat facts {};
  exists = ::stat(file.c_str(), &facts) == 0;
  if (exists) {
    is_special = !S_ISREG(facts.st_mode) && !S_ISDIR(facts.st_mode);
    device = facts.st_dev, inode = facts.st_ino;
    return;
  }
  std::error_code error;
  const fs::path target = fs::absolute(where_written(file), error);
  folded = fs::weakly_canonical(target, error).string();
  if (error) folded = target.lexically_normal().string();
  std::ranges::transform(folded, folded.begin(), [](unsigned char c) { return std::tolower(c); });
}

bool RunFiles::Place::operator==(const Place& other) const {
  if (exists != other.exists || is_special || other.is_special) return false;
  return exists ? device == other.device && inode == other.inode : folded == other.folded;
}

void RunFiles::check_apart(const Known& a, const Known& b, const fs::path& file) {
  if (a.place == b.place)
    throw Error(ErrorCode::usage, fmt::format("{} and {} are the same file, {}; give them different names",
                                              a.what, b.what, file.string()));
}

void RunFiles::read(const std::string& what, const fs::path& file) {
  if (file.empty() || file == "-") return;
  const Known input{what, Place(file)};
  for (const Known& output : outputs_) check_apart(input, output, file);
  inputs_.push_back(input);
}

void RunFiles::read_scene(std::span<const scene::FileRead> files) {
  for (const scene::FileRead& named : files) read("a file that the scene names", named.path);
}

void RunFiles::write(const std::string& option, const fs::path& file) {
  if (file.empty()) return;
  if (file == "-") {
    if (!to_stdout_.empty())
      throw Error(ErrorCode::usage, fmt::format("{} and {} both go to standard output; name a file for one",
                                                to_stdout_, option));
    to_stdout_ = option;
    return;
  }
  const Known output{option, Place(file)};
  for (const Known& input : inputs_) check_apart(input, output, file);
  for (const Known& other : outputs_) check_apart(other, output, file);
  check_writable(file);
  outputs_.push_back(output);
}

void RunFiles::write_folder(const std::string& option, const fs::path& folder) {
  const Known output{option, Place(folder)};
  for (const Known& input : inputs_) check_apart(input, output, folder);
  for (const Known& other : outputs_) check_apart(other, output, folder);
  outputs_.push_back(output);
}

void RunFiles::write_picture(const std::string& option, const fs::path& file,
                             std::span<const std::string> channels, const image::WriteOptions& options) {
  if (file.empty()) return;
  std::error_code error;
  const bool is_stdout = file == "-";
  if (is_stdout) check_stdout_takes_bytes(option);
  if (is_stdout || fs::is_other(file, error)) {
    if (!channels.empty() && options.format != image::PictureFormat::exr)
      throw Error(ErrorCode::usage,
                  fmt::format("--aov makes more pictures beside a PNG, and {} has room for one; take "
                              "--format exr, which holds them all",
                              is_stdout ? "standard output" : file.string()));
    return write(option, file);
  }
  for (const fs::path& one : image::picture_files(file, channels, options))
    write(one == file ? option : "--aov", one);
}

bool RunFiles::is_taken(const Place& place) const {
  const auto is_there = [&](const Known& known) { return known.place == place; };
  return std::ranges::any_of(inputs_, is_there) || std::ranges::any_of(outputs_, is_there);
}

fs::path RunFiles::free_name(const fs::path& picture, std::span<const std::string> channels,
                             const image::WriteOptions& options) const {
  const auto taken = [&](const fs::path& name) {
    return std::ranges::any_of(image::picture_files(name, channels, options),
                               [&](const fs::path& file) { return is_taken(Place(file)); });
  };
  fs::path name = picture;
  for (int n = 1; taken(name); ++n) {
    const std::string number = n > 1 ? std::to_string(n) : "";
    name = picture;
    name.replace_filename(picture.stem().string() + ".kdray" + number + picture.extension().string());
  }
  return name;
}

void check_stdout_takes_bytes(const std::string& option) {
  if (::isatty(STDOUT_FILENO))
    throw Error(ErrorCode::usage,
                option +
                    " '-': standard output is a terminal, as it is under mpirun; send it to a file or "
                    "program, or name a file");
}

}  // namespace kdray::cli
