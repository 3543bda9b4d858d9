#include "scene/import/json/json_node.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "io/image/color.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene {

namespace {

using nlohmann::json;

std::size_t line_at(std::string_view text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return 1 + static_cast<std::size_t>(std::count(text.begin(), end, '\n'));
}

// nlohmann's message without its own prefix: "[json.exception.parse_error.101] parse error at line 2, column
// 3: ...".
std::string short_message(const char* what) {
  std::string_view text = what;
  const std::size_t detail = text.find(": ");
  if (detail != std::string_view::npos) text.remove_prefix(detail + 2);
  return printable(text.substr(0, 160)).size() < text.size() ? std::string(text.substr(0, 160))
                                                             : std::string(text);
}

// Builds a document. (json::parse() with a callback goes through all of a list whenever a part of it ends.)
class Builder final : public json::json_sax_t {
 public:
  Builder(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t& value) override { return put(std::move(value)); }
  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  // A key given twice is nearly always a mistake, and JSON readers disagree on which counts.
  bool key(string_t& key) override {
    if (open_.back()->contains(key))
      throw input_error(file_, 0, "the key '" + printable(key) + "' is given twice in one object",
                        "remove one");
    key_ = std::move(key);
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const json::exception& error) override;

 private:
  template <class T>
  json& place(T&& value) {
    if (open_.empty()) return root_ = std::forward<T>(value);
    json& parent = *open_.back();
    return parent.is_array() ? parent.emplace_back(std::forward<T>(value))
                             : parent[key_] = std::forward<T>(value);
  }
  template <class T>
  bool put(T&& value) {
    place(std::forward<T>(value));
    return true;
  }
  bool open(json&& value) {
    open_.push_back(&place(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::string_view text_;
  const std::string& file_;
  json root_;
  std::vector<json*> open_;  // lists and objects, each in the one before
  std::string key_;          // of what comes next in an object
};

const char* type_name(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return "an array";
    case json::value_t::string:
      return "a string";
    case json::value_t::boolean:
      return "true or false";
    default:
      return "a number";
  }
}

// Returns what an error shows of a value: the value itself when it is short, or else its type.
std::string shown(const json& value) {
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_object() || value.is_null()) return type_name(value);
  return printable(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

std::string escaped(std::string_view key) {
  std::string out;
  for (const char c : key) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

bool read_vector(const json& value, dvec3& out) {
  if (!value.is_array() || value.size() != 3) return false;
  for (int i = 0; i < 3; ++i) {
    if (!value[static_cast<std::size_t>(i)].is_number()) return false;
    out[i] = value[static_cast<std::size_t>(i)].get<double>();
  }
  return is_finite(out);
}

}  // namespace

namespace {

// Returns whether one begins where the parser stopped, which is at its first or second character.
bool is_comment(std::string_view text, std::size_t at) {
  for (std::size_t first = at > 0 ? at - 1 : 0; first <= at && first < text.size(); ++first) {
    const std::string_view two = text.substr(first, 2);
    if (two == "//" || two == "/*") return true;
  }
  return at < text.size() && text[at] == '#';
}

bool Builder::parse_error(std::size_t position, const std::string& token, const json::exception& error) {
  const std::size_t at = position > 0 ? position - 1 : 0, line = line_at(text_, at);
  if (dynamic_cast<const json::parse_error*>(&error) == nullptr)
    throw input_error(file_, line, token + " is beyond what a number holds, 1.8e308");
  if (at >= text_.size() && !open_.empty())
    throw input_error(file_, line,
                      "not JSON: the text ends inside of " + std::to_string(open_.size()) + " open brackets",
                      "it is cut short, or nested without an end: fetch or write it again");
  throw input_error(file_, line, "not JSON: " + short_message(error.what()),
                    is_comment(text_, at) ? "JSON has no comments: take them out" : "");
}

}  // namespace

json parse_json(std::string_view text, const std::string& file) {
  Builder builder(text, file);
  json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

JsonNode JsonNode::child(const json& value, std::string_view key) const {
  JsonNode node(value, *file_);
  node.path_ = path_ + "/" + escaped(key);
  return node;
}

std::string JsonNode::place() const {
  return *file_ + ": " + (path_.empty() ? "the scene" : path_);
}

Error JsonNode::error(const std::string& what, const std::string& remedy) const {
  return input_error(place(), 0, what, remedy);
}

Error JsonNode::expected(const std::string& what) const {
  return error("expected " + what + ", found " + shown(*value_));
}

void JsonNode::expect_keys(const JsonKeys& allowed) const {
  if (!value_->is_object()) throw expected("an object");
  for (const auto& [key, value] : value_->items()) {
    if (std::ranges::find(allowed.keys, key) != allowed.keys.end()) continue;
    std::string known = "known are";
    for (const std::string_view name : allowed.keys) known.append(" ").append(name);
    const std::string guess = did_you_mean(key, allowed.keys);
    throw child(value, printable(key)).error("unknown key", guess.empty() ? known : guess);
  }
}

JsonNode JsonNode::operator[](std::string_view key) const {
  const std::optional<JsonNode> node = find(key);
  if (!node) throw error("lacks '" + std::string(key) + "'");
  return *node;
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
  if (!value_->is_object()) throw expected("an object");
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return child(*it, key);
}

std::vector<JsonNode> JsonNode::elements() const {
  if (!value_->is_array()) throw expected("an array");
  std::vector<JsonNode> nodes;
  nodes.reserve(value_->size());
  for (const json& v : *value_) nodes.push_back(child(v, std::to_string(nodes.size())));
  return nodes;
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  if (!value_->is_object()) throw expected("an object");
  std::vector<std::pair<std::string, JsonNode>> nodes;
  for (const auto& [key, value] : value_->items()) nodes.emplace_back(key, child(value, key));
  return nodes;
}

double JsonNode::number() const {
  if (!value_->is_number()) throw expected("a number");
  const double v = value_->get<double>();
  if (!std::isfinite(v)) throw expected("a finite number");
  return v;
}

double JsonNode::number_above(double low) const {
  const double v = number();
  if (!(v > low)) throw expected("a number above " + json(low).dump());
  return v;
}

double JsonNode::number_from(double low) const {
  const double v = number();
  if (!(v >= low)) throw expected("a number of at least " + json(low).dump());
  return v;
}

double JsonNode::number_between(double low, double high) const {
  const double v = number();
  if (!(v >= low && v <= high))
    throw expected("a number from " + json(low).dump() + " to " + json(high).dump());
  return v;
}

int JsonNode::integer(int low, int high) const {
  const auto wanted = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (!value_->is_number_integer()) throw expected(wanted);
  const double v = value_->get<double>();
  if (v < low || v > high) throw expected(wanted);
  return static_cast<int>(v);
}

dvec3 JsonNode::vector() const {
  dvec3 v;
  if (!read_vector(*value_, v)) throw expected("three numbers [x, y, z]");
  return v;
}

dvec3 JsonNode::direction() const {
  const dvec3 v = vector();
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) throw error("a direction of [0, 0, 0]");
  return glm::normalize(v / largest);
}

vec3 JsonNode::color() const {
  if (value_->is_string())
    if (const auto color = image::css_color(value_->get<std::string>())) return *color;
  dvec3 v;
  if (value_->is_number()) {
    v = dvec3(number());
  } else if (!read_vector(*value_, v)) {
    throw expected("a number, [red, green, blue], or a colour as CSS has it");
  }
  const vec3 c(v);
  if (c.x < 0 || c.y < 0 || c.z < 0) throw error("a value below 0");
  if (!is_finite(dvec3(c))) throw error("a value beyond 3.4e38");
  return c;
}

std::string JsonNode::string() const {
  if (!value_->is_string()) throw expected("a string");
  return value_->get<std::string>();
}

bool JsonNode::boolean() const {
  if (!value_->is_boolean()) throw expected("true or false");
  return value_->get<bool>();
}

RawVector<dvec3> JsonNode::vectors() const {
  if (!value_->is_array()) throw expected("an array of [x, y, z]");
  RawVector<dvec3> out(value_->size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const json& v = (*value_)[i];
    if (!read_vector(v, out[i])) throw child(v, std::to_string(i)).expected("three numbers [x, y, z]");
  }
  return out;
}

std::vector<std::vector<std::uint32_t>> JsonNode::faces(std::size_t n_corners) const {
  if (!value_->is_array()) throw expected("an array of faces");
  std::vector<std::vector<std::uint32_t>> out(value_->size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const json& face = (*value_)[i];
    const auto fault = [&] {
      return child(face, std::to_string(i))
          .error("expected three or more vertex numbers from 0 to " + std::to_string(n_corners) + " - 1");
    };
    if (!face.is_array() || face.size() < 3) throw fault();
    for (const json& corner : face) {
      if (!corner.is_number_unsigned() || corner.get<std::uint64_t>() >= n_corners) throw fault();
      out[i].push_back(corner.get<std::uint32_t>());
    }
  }
  return out;
}

}  // namespace kdray::scene
