#include "scene/import/gltf/gltf_materials.h"

#include <cmath>

#include "base/error.h"
#include "scene/import/text_scanner.h"
#include "scene/textures/picture.h"

namespace kdray::scene::gltf {

namespace {

constexpr std::uint64_t kNearest = 9728, kRepeat = 10497, kClamp = 33071, kMirror = 33648;

Wrap wrap_of(const JsonNode& sampler, std::string_view key) {
  switch (whole_or(sampler, key, kRepeat)) {
    case kClamp:
      return Wrap::clamp;
    case kMirror:
      return Wrap::mirror;
    case kRepeat:
      return Wrap::repeat;
    default:
      throw sampler[key].expected("10497, 33071 or 33648");
  }
}

// Without a filter a picture is shown by all its mipmaps, which the format leaves to the program.
Minify minify_of(const JsonNode& sampler) {
  constexpr std::string_view kKey = "minFilter";
  constexpr std::uint64_t kLinear = 9729, kFirstOfMipmaps = 9984, kLastOfMipmaps = 9987;
  const std::uint64_t filter = whole_or(sampler, kKey, kLastOfMipmaps);
  if (filter == kNearest) return Minify::nearest;
  if (filter == kLinear) return Minify::linear;
  if (filter < kFirstOfMipmaps || filter > kLastOfMipmaps)
    throw sampler[kKey].expected("9728, 9729 or one of 9984 to 9987");
  // In the same order: nearest and linear, of the nearer mipmap and then of two.
  return static_cast<Minify>(static_cast<std::uint64_t>(Minify::nearest_mipmap_nearest) + filter -
                             kFirstOfMipmaps);
}

struct Pair {
  double u, v;
};

Pair pair_or(const JsonNode& object, std::string_view key, Pair otherwise) {
  const auto node = object.find(key);
  if (!node) return otherwise;
  const std::vector<JsonNode> parts = node->elements();
  if (parts.size() != 2) throw node->expected("two numbers");
  return {parts[0].number(), parts[1].number()};
}

float narrow(const JsonNode& node, double value) {
  const auto f = static_cast<float>(value);
  if (!std::isfinite(f)) throw node.error("a value beyond 3.4e38");
  return f;
}

// Scaled, then turned, then moved.
void read_transform(const JsonNode& transform, Texture& out) {
  const Pair offset = pair_or(transform, "offset", {0, 0}), scale = pair_or(transform, "scale", {1, 1});
  const double angle = number_or(transform, "rotation", 0), c = std::cos(angle), s = std::sin(angle);
  const auto f = [&](double value) { return narrow(transform, value); };
  out.across = {f(c * scale.u), f(s * scale.v), f(offset.u)};
  out.down = {f(-s * scale.u), f(c * scale.v), f(offset.v)};
}

std::string name_of(const JsonNode& image, std::uint64_t number) {
  const auto uri = image.find("uri");
  if (uri && !uri->string().starts_with("data:")) return printable(uri->string());
  return "image " + std::to_string(number);
}

}  // namespace

std::uint32_t Textures::decode(const JsonNode& image, std::uint64_t number) {
  const std::string name = document_.file() + ": " + name_of(image, number);
  std::string from_elsewhere;
  std::string_view bytes;
  if (const auto uri = image.find("uri")) {
    from_elsewhere = document_.read_uri(*uri);
    bytes = from_elsewhere;
  } else {
    bytes = document_.view_bytes(document_.entry("bufferViews", image["bufferView"]));
  }
  return scene_.texturing.add(decode_picture(bytes, name, scene_.warnings));
}

// Warns once for each picture, however many textures show it.
std::optional<std::uint32_t> Textures::picture_of(const JsonNode& texture) {
  const auto webp = extension(texture, "EXT_texture_webp");
  const auto source = texture.find("source") ? texture.find("source")
                      : webp                 ? webp->find("source")
                                             : std::nullopt;
  if (!source) throw texture.error("names no PNG, JPEG or WebP");
  const std::uint64_t number = whole(*source);
  const JsonNode& image = document_.entry("images", *source);
  const auto [it, added] = pictures_.try_emplace(number);
  if (added) it->second = decode(image, number);
  return it->second;
}

void Textures::read_sampler(const JsonNode& texture, Texture& out) {
  const auto index = texture.find("sampler");
  if (!index) return;
  const JsonNode& sampler = document_.entry("samplers", *index);
  out.wrap_across = wrap_of(sampler, "wrapS");
  out.wrap_down = wrap_of(sampler, "wrapT");
  out.nearest = whole_or(sampler, "magFilter", 0) == kNearest;
  out.minify = minify_of(sampler);
}

std::optional<std::uint32_t> Textures::number_of(const JsonNode& info, bool curved) {
  try {
    return read(info, curved);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    scene_.warnings.push_back(std::string(error.what()) + " (the picture is left out)");
    return std::nullopt;
  }
}

std::optional<std::uint32_t> Textures::read(const JsonNode& info, bool curved) {
  const JsonNode& texture = document_.entry("textures", info["index"]);
  const auto picture = picture_of(texture);
  if (!picture) return std::nullopt;
  Texture out{.picture = *picture, .minify = Minify::linear_mipmap_linear, .curved = curved};
  read_sampler(texture, out);
  std::uint64_t set = whole_or(info, "texCoord", 0);
  if (const auto transform = extension(info, "KHR_texture_transform")) {
    read_transform(*transform, out);
    set = whole_or(*transform, "texCoord", set);
  }
  if (set > 1) throw info.error("uses TEXCOORD_" + std::to_string(set) + "; two sets are read");
  out.set = static_cast<std::uint32_t>(set);
  return scene_.texturing.add(out);
}

}  // namespace kdray::scene::gltf
