// What    The files that a run reads and writes. No file is written that is read, or that the scene names
//         without kdray reading it (a texture), and none is written twice.
// Shape   Each file is noted as soon as it is known. Outputs are also checked for being writable, so that a
//         long run doesn't end without a place for its results. "-" is standard output, for one of them.
//         Two names are the same file when they lead to the same one: by links, by "." and "..". While
//         neither exists, capitals don't count, for the file system may not tell them apart.
// Errors  kdray::Error: ErrorCode::usage for options that contradict each other, ErrorCode::input for a place
//         that can't be written.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/image/picture_file.h"
#include "scene/import/files.h"

namespace kdray::cli {

class RunFiles {
 public:
  // Notes an input, which `what` ("SCENE", "--rays") names. "-" is standard input.
  void read(const std::string& what, const std::filesystem::path& file);
  // Notes all files that a scene names, once it is loaded.
  void read_scene(std::span<const scene::FileRead> files);

  // Notes an output; without a name there is none.
  void write(const std::string& option, const std::filesystem::path& file);
  // Notes a folder that is made where it isn't there.
  void write_folder(const std::string& option, const std::filesystem::path& folder);
  // Notes a picture with its channels' pictures.
  void write_picture(const std::string& option, const std::filesystem::path& file,
                     std::span<const std::string> channels, const image::WriteOptions& options);

  // Returns the first of NAME.png, NAME.kdray.png, NAME.kdray2.png, ... that is not taken, for a picture
  // without a name.
  std::filesystem::path free_name(const std::filesystem::path& picture, std::span<const std::string> channels,
                                  const image::WriteOptions& options) const;

 private:
  // Where a name leads to.
  struct Place {
    explicit Place(const std::filesystem::path& file);
    bool operator==(const Place& other) const;

    bool exists = false, is_special = false;  // a device or a pipe, which writing doesn't destroy
    dev_t device = 0;
    ino_t inode = 0;
    std::string folded;  // the name in full, in small letters
  };
  struct Known {
    std::string what;
    Place place;
  };

  static void check_apart(const Known& a, const Known& b, const std::filesystem::path& file);
  bool is_taken(const Place& place) const;

  std::vector<Known> inputs_, outputs_;
  std::string to_stdout_;  // the option whose output goes there
};

// Throws where standard output is a terminal, which shows no pictures and arrays.
void check_stdout_takes_bytes(const std::string& option);

}  // namespace kdray::cli
