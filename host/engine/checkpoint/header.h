// What    What a checkpoint is of: hashes of the scene, of the settings and of what computes the picture, and
//         how the picture is cut into tiles. It is what a run must have in common with a checkpoint to go on
//         from it, and what every file of tiles begins with.
// Shape   1024 bytes: fixed fields, then texts for people, then a checksum of all that.
// Errors  check_same(): ErrorCode::input, in a line that says which of them differs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/hash.h"
#include "engine/checkpoint/record.h"

namespace kdray::checkpoint {

// Three hashes instead of one, so that a message can tell what differs.
struct Identity {
  Hash scene;     // shapes, materials, lights
  Hash settings;  // camera, size, samples, depth, ...
  Hash build;     // kdray's code, the driver
  std::string settings_text, build_text;
};

// Of the picture, in pixels.
struct Cut {
  std::uint32_t width = 0, height = 0, tile_width = 0, tile_height = 0;
  bool operator==(const Cut&) const = default;
};

// Where a record's sums belong: of a picture that is cut so, or of a list of samples.
Rectangle places_of(const Cut& cut, std::uint32_t round, std::uint32_t number);

struct Header {
  Identity identity;
  Cut cut;
  std::string maker;  // of the file: a machine, its device

  // What the records of such a frame are marked with.
  Hash frame() const;
};

inline constexpr std::size_t kHeaderBytes = 1024;

std::string to_bytes(const Header& header);
std::optional<Header> header_of(std::string_view bytes);  // none: damaged, or of another version

// Throws where a run of this identity can't go on from the checkpoint that is in the folder.
void check_same(const std::filesystem::path& folder, const Identity& checkpoint, const Identity& run);

}  // namespace kdray::checkpoint
