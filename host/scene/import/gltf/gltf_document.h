// What    A glTF 2.0 file taken apart: its JSON, whose arrays are available as nodes, and its buffers, which
//         are read when they are first used.
// Shape   .gltf or .glb, recognised by the first bytes. Buffers may be in the GLB itself, in data: URIs, or
//         in files that the scene may name (files.h).
// Errors  kdray::Error: the JSON's line for what is not JSON, the value's path ("/accessors/3/count")
//         otherwise.
// Source  Khronos Group, "glTF 2.0 Specification", 2021.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/import/json/json_node.h"

namespace kdray::scene::gltf {

// The numbers of an accessor that were packed (gltf_packed.h), one after the other.
struct Unpacked {
  std::string bytes;
  std::uint64_t count = 0;
  std::uint32_t component = 5126;  // glTF's number for a component's type
};

class Document {
 public:
  // `text` must outlive the document.
  Document(std::string_view text, const std::filesystem::path& path);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  JsonNode root() const { return {json_, file_}; }
  const nlohmann::json& json() const { return json_; }
  const std::string& file() const { return file_; }
  std::size_t file_size() const { return text_.size(); }
  const std::vector<std::string>& warnings() const { return warnings_; }  // of the file as a whole
  // Returns the number of bytes so far: of the file, of buffers beside it, and of unpacked ones.
  std::uint64_t bytes_read() const { return bytes_read_ + bytes_unpacked_; }

  // Returns the entry of a top-level array ("nodes", "meshes", ...) that `index` names; an error when there
  // is none.
  const JsonNode& entry(const std::string& array, const JsonNode& index);
  const std::vector<JsonNode>& entries(const std::string& array);

  // Returns the bytes that a "uri" stands for: data, or a file.
  std::string read_uri(const JsonNode& uri) const;
  // Returns the bytes of a bufferView, which has them all; a packed one is unpacked.
  std::string_view view_bytes(const JsonNode& view);

  // Puts numbers in the place of an accessor's buffer view, until forget_unpacked().
  void put(const JsonNode& accessor, Unpacked unpacked) { unpacked_[accessor.id()] = std::move(unpacked); }
  const Unpacked* unpacked(const JsonNode& accessor) const;
  void forget_unpacked() { unpacked_.clear(); }
  // Refuses streams that unpack to more than any mesh does; called before `n` bytes are unpacked.
  void count_unpacked(std::uint64_t n, const JsonNode& packed);

 private:
  void split_glb();
  void check_asset();
  void check_extensions() const;
  void note_files() const;
  std::string_view slice(const JsonNode& view);
  std::string_view buffer_bytes(const JsonNode& index);
  bool has_bytes(const JsonNode& buffer_index);

  std::string_view text_;
  std::vector<std::string> warnings_;
  std::string_view json_text_;
  std::optional<std::string_view> binary_chunk_;
  std::filesystem::path path_;
  std::string file_;
  nlohmann::json json_;
  std::map<std::string, std::vector<JsonNode>> arrays_;
  std::map<std::size_t, std::string> buffers_;         // read from elsewhere, by number
  std::map<const void*, std::string> unpacked_views_;  // by the views' ids
  std::map<const void*, Unpacked> unpacked_;           // by the accessors' ids
  std::uint64_t bytes_read_ = 0, bytes_unpacked_ = 0;
};

// Returns a whole number from 0 to 2^53.
std::uint64_t whole(const JsonNode& node);
// Return `key`'s number, or `otherwise` when the object has no such key.
std::uint64_t whole_or(const JsonNode& object, std::string_view key, std::uint64_t otherwise);
double number_or(const JsonNode& object, std::string_view key, double otherwise);
// Returns the object's name, which says nothing of it; empty where it has none.
std::string name_of(const JsonNode& object);
// Returns the object's extension of this name.
std::optional<JsonNode> extension(const JsonNode& object, std::string_view name);

// ---- The URIs of buffers and pictures: bytes in base64, and names of files.

// Returns the bytes of "data:[type];base64,...", or nothing when it is not one.
std::optional<std::string> decode_data_uri(std::string_view uri);

// Returns the text with each "%20" replaced by the character that it stands for.
std::string percent_decoded(std::string_view text);

// Returns the paths that a URI may mean, percent-decoded: as it stands, with backslashes as slashes, and
// without the query or fragment that web servers' files have behind their names. None for other schemes
// (http:).
std::vector<std::filesystem::path> paths_of(std::string_view uri);

// Returns what of a glTF file is not read, by name and number, so that users know: extensions, scenes,
// animations while the file is at rest, sets of coordinates and colours. Materials and textures report their
// own (gltf_materials.h).
std::vector<std::string> left_out_of(Document& document, bool at_rest);

}  // namespace kdray::scene::gltf
