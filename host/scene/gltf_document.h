// What    A glTF 2.0 file taken apart: its JSON, whose arrays are at hand as nodes, and its buffers, which
//         are read when they are first asked for.
// Shape   .gltf or .glb, told by the first bytes. Buffers may be in the GLB itself, in data: URIs, or in
//         files beside the scene or below.
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

#include "scene/json_node.h"

namespace kdray::scene::gltf {

class Document {
 public:
  // `text` must outlive the document.
  Document(std::string_view text, const std::filesystem::path& path);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  JsonNode root() const { return {json_, file_}; }
  const std::string& file() const { return file_; }
  std::size_t file_size() const { return text_.size(); }

  // The entry of a top-level array ("nodes", "meshes", ...) that `index` names; an error when there is none.
  const JsonNode& entry(const std::string& array, const JsonNode& index);
  const std::vector<JsonNode>& entries(const std::string& array);

  // The bytes that a "uri" stands for: data, or a file beside the scene or below.
  std::string read_uri(const JsonNode& uri) const;
  // The bytes of a bufferView, all of which are there.
  std::string_view view_bytes(const JsonNode& view);

 private:
  void split_glb();
  void check_asset();
  void check_extensions();
  void note_files() const;
  std::string_view buffer_bytes(const JsonNode& index);

  std::string_view text_;
  std::string_view json_text_;
  std::optional<std::string_view> binary_chunk_;
  std::filesystem::path path_;
  std::string file_;
  nlohmann::json json_;
  std::map<std::string, std::vector<JsonNode>> arrays_;
  std::map<std::size_t, std::string> buffers_;  // read from elsewhere, by number
};

// A whole number from 0 to 2^53.
std::uint64_t whole(const JsonNode& node);
// `key`'s whole number, or `otherwise` when the object has no such key.
std::uint64_t whole_or(const JsonNode& object, std::string_view key, std::uint64_t otherwise);
double number_or(const JsonNode& object, std::string_view key, double otherwise);
// The object's extension of this name.
std::optional<JsonNode> extension(const JsonNode& object, std::string_view name);

}  // namespace kdray::scene::gltf
