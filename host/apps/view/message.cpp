#include "apps/view/message.h"

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "base/error.h"

namespace kdray::view {

namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::input, "the page's message: " + what);
}

// Reads an object's fields one by one; end() refuses those that nobody has read.
class Fields {
 public:
  explicit Fields(const Json& object) : object_(object) {
    if (!object.is_object()) refuse("an object was expected");
  }
  const Json* find(const char* name) {
    const auto found = object_.find(name);
    if (found == object_.end()) return nullptr;
    ++n_read_;
    return &*found;
  }
  const Json& get(const char* name) {
    const Json* const value = find(name);
    if (value == nullptr) refuse(std::string(name) + " is missing");
    return *value;
  }
  double real(const Json& value, const char* name, double lo, double hi) const {
    if (!value.is_number()) refuse(std::string(name) + " is no number");
    const double number = value.get<double>();
    if (!(number >= lo && number <= hi)) refuse(std::string(name) + " is out of range");
    return number;
  }
  double real(const char* name, double lo, double hi) { return real(get(name), name, lo, hi); }
  std::int64_t whole(const char* name, std::int64_t lo, std::int64_t hi) {
    const double number = real(name, static_cast<double>(lo), static_cast<double>(hi));
    if (number != std::floor(number)) refuse(std::string(name) + " is no whole number");
    return static_cast<std::int64_t>(number);
  }
  std::uint32_t number(const char* name) { return static_cast<std::uint32_t>(whole(name, 0, 0xffffffffll)); }
  Vec3 vector(const char* name) {
    constexpr double kMost = 1e300;
    const Json& value = get(name);
    if (!value.is_array() || value.size() != 3) refuse(std::string(name) + " is no vector");
    Vec3 v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = real(value[k], name, -kMost, kMost);
    return v;
  }
  template <std::size_t kN>
  int choice(const char* name, const std::array<std::string_view, kN>& names) {
    return choice(get(name), name, names);
  }
  template <std::size_t kN>
  int choice(const Json& value, const char* name, const std::array<std::string_view, kN>& names) const {
    for (std::size_t i = 0; value.is_string() && i < kN; ++i)
      if (value.get_ref<const std::string&>() == names[i]) return static_cast<int>(i);
    refuse(std::string(name) + " is none of its choices");
  }
  void end() const {
    if (n_read_ != object_.size()) refuse("there is a field that means nothing");
  }

 private:
  const Json& object_;
  std::size_t n_read_ = 0;
};

Camera camera_of(const Json& value) {
  Fields fields(value);
  Camera camera;
  camera.from = fields.vector("from");
  camera.at = fields.vector("at");
  camera.up = fields.vector("up");
  camera.fov = fields.real("fov", 1e-3, 179.9);
  camera.ortho_width = fields.real("ortho", 0, 1e300);
  fields.end();
  return camera;
}

// Left out or null: as the command line or the scene has it.
void read_background(const Json& value, const Fields& fields, ViewRequest& request) {
  if (value.is_null()) return;
  if (!value.is_array() || value.size() != 3) refuse("background is no colour");
  std::array<float, 3>& color = request.background.emplace();
  for (std::size_t k = 0; k < 3; ++k)
    color[k] = static_cast<float>(fields.real(value[k], "background", 0, 1));
}

void read_samples(const Json& value, Fields& fields, ViewRequest& request) {
  constexpr int kMost = 1024;
  if (value == "adaptive") {
    request.samples = Samples::adaptive;
    return;
  }
  const double n = fields.real(value, "samples", 0, kMost);
  if (n != std::floor(n)) refuse("samples is no whole number");
  request.samples = n > 0 ? Samples::number : Samples::as_given;
  request.n_samples = std::max(1, static_cast<int>(n));
}

ViewRequest view_request_of(const Json& value) {
  static constexpr std::array<std::string_view, 7> kChannels = {"",     "depth",   "normal", "primitive",
                                                                "cost", "samples", "queue"};
  Fields fields(value);
  ViewRequest request;
  request.scene = static_cast<std::size_t>(fields.whole("scene", 0, 1 << 20));
  request.camera = camera_of(fields.get("camera"));
  request.width = static_cast<int>(fields.whole("width", 1, kMostSide));
  request.height = static_cast<int>(fields.whole("height", 1, kMostSide));
  if (request.width * request.height > kMostPixels) refuse("the picture is too large");
  request.depth = static_cast<int>(fields.whole("depth", 0, 64));
  read_samples(fields.get("samples"), fields, request);
  request.min_weight = fields.real("weight", -1, 1);
  request.headlight = fields.real("headlight", 0, 1000);
  if (const Json* const background = fields.find("background")) read_background(*background, fields, request);
  if (const Json* const look = fields.find("look"); look != nullptr && !look->is_null())
    request.look = static_cast<kdray::Look>(fields.choice(*look, "look", kLooks));
  request.channel = kChannels[static_cast<std::size_t>(fields.choice("channel", kChannels))];
  request.mode = static_cast<Mode>(fields.choice("mode", kModes));
  request.traversal = static_cast<Traversal>(fields.choice("traversal", kWalks));
  request.queues = static_cast<int>(fields.whole("queues", 0, 64));
  fields.end();
  return request;
}

Json parsed(std::string_view text) {
  if (text.size() > kMostText) refuse("it is too long");
  Json value = Json::parse(text, nullptr, false);
  if (value.is_discarded()) refuse("it is no JSON");
  return value;
}

Look look_of(Fields& fields) {
  Look look;
  look.number = fields.number("number");
  const Json& moving = fields.get("moving");
  if (!moving.is_boolean()) refuse("moving is neither true nor false");
  look.moving = moving.get<bool>();
  look.request = view_request_of(fields.get("sight"));
  return look;
}

Pick pick_of(Fields& fields) {
  Pick pick;
  pick.number = fields.number("number");
  pick.x = fields.real("x", 0, 1);
  pick.y = fields.real("y", 0, 1);
  pick.request = view_request_of(fields.get("sight"));
  return pick;
}

}  // namespace

Message parse_message(std::string_view text) {
  static constexpr std::array<std::string_view, 5> kTypes = {"look", "shown", "pick", "cells", "smooth"};
  const Json value = parsed(text);
  Fields fields(value);
  Message message;
  switch (fields.choice("type", kTypes)) {
    case 0:
      message = look_of(fields);
      break;
    case 1:
      message = Shown{fields.number("frame")};
      break;
    case 2:
      message = pick_of(fields);
      break;
    case 3:
      message = Cells{static_cast<std::size_t>(fields.whole("scene", 0, 1 << 20)),
                      static_cast<int>(fields.whole("depth", 0, kMostCellDepth))};
      break;
    default:
      message =
          Smooth{static_cast<std::size_t>(fields.whole("scene", 0, 1 << 20)), fields.real("degrees", 0, 180)};
  }
  fields.end();
  return message;
}

std::string token_of_hello(std::string_view text) {
  const Json value = parsed(text);
  Fields fields(value);
  if (fields.get("type") != "hello") refuse("hello was expected");
  const Json& token = fields.get("token");
  if (!token.is_string()) refuse("the token is no text");
  fields.end();
  return token.get<std::string>();
}

}  // namespace kdray::view
