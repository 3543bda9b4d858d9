// What    A value of a JSON scene together with its place in the file, read with checks: unknown keys,
//         missing keys and wrong types are refused with the value's path (a JSON pointer, RFC 6901) and what
//         was wanted there.
// Errors  parse_json: "file:line: what" for what is not JSON, and for a key given twice. JsonNode: "file:
//         /objects/3/radius: expected a number, found a string".
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/memory.h"
#include "base/vec.h"
#include "scene/import/json/json_keys.h"

namespace kdray::scene {

nlohmann::json parse_json(std::string_view text, const std::string& file);

class JsonNode {
 public:
  // `value` and `file` must outlive the node.
  JsonNode(const nlohmann::json& value, const std::string& file) : value_(&value), file_(&file) {}

  // The value must be an object with no other keys than these.
  void expect_keys(const JsonKeys& allowed) const;

  JsonNode operator[](std::string_view key) const;  // refuses an object without this key
  std::optional<JsonNode> find(std::string_view key) const;
  std::vector<JsonNode> elements() const;                         // of an array
  std::vector<std::pair<std::string, JsonNode>> members() const;  // of an object, by key

  double number() const;  // finite
  double number_above(double low) const;
  double number_from(double low) const;
  double number_between(double low, double high) const;  // both ends allowed
  int integer(int low, int high) const;
  dvec3 vector() const;     // [x, y, z]
  dvec3 direction() const;  // [x, y, z] made unit length; not [0, 0, 0]
  vec3 color() const;       // a number for grey, [red, green, blue], or as CSS has it; none below 0
  std::string string() const;
  bool boolean() const;

  // [[x, y, z], ...] and [[corner, corner, corner, ...], ...] without a node per element: meshes are large.
  // The corners are below `n_corners`, three or more to a face.
  RawVector<dvec3> vectors() const;
  std::vector<std::vector<std::uint32_t>> faces(std::size_t n_corners) const;

  bool is_string() const { return value_->is_string(); }
  bool is_array() const { return value_->is_array(); }
  bool is_object() const { return value_->is_object(); }
  std::size_t size() const { return value_->size(); }
  const std::string& file() const { return *file_; }
  // Is the same for all nodes of one value.
  const void* id() const { return value_; }

  std::string place() const;  // as errors name it: "file: /path/of/the/value"
  [[nodiscard]] Error error(const std::string& what, const std::string& remedy = "") const;
  [[nodiscard]] Error expected(const std::string& what) const;

 private:
  JsonNode child(const nlohmann::json& value, std::string_view key) const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string path_;
};

}  // namespace kdray::scene
