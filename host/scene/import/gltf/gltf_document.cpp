#include "scene/import/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/gltf/gltf_packed.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene::gltf {

// ---- URIs

namespace {

constexpr std::array<std::int8_t, 256> make_digits() {
  std::array<std::int8_t, 256> digits{};
  digits.fill(-1);
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  }
  return digits;
}

std::optional<std::string> decode_base64(std::string_view text) {
  static constexpr std::array<std::int8_t, 256> kDigits = make_digits();
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int n_bits = 0;
  for (const char c : text) {
    const std::int8_t digit = kDigits[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    n_bits += 6;
    if (n_bits >= 8) {
      n_bits -= 8;
      bytes += static_cast<char>(bits >> n_bits & 0xff);
    }
  }
  return bytes;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::optional<std::string> decode_data_uri(std::string_view uri) {
  constexpr std::string_view kMark = ";base64,";
  // The mark is in the short head of the URI; the data may be gigabytes.
  const std::size_t mark = uri.substr(0, 256).find(kMark);
  if (!uri.starts_with("data:") || mark == std::string_view::npos) return std::nullopt;
  return decode_base64(uri.substr(mark + kMark.size()));
}

std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool coded =
        text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
    if (coded) {
      out += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::vector<std::filesystem::path> paths_of(std::string_view uri) {
  std::vector<std::filesystem::path> paths;
  const std::size_t colon = uri.find(':');
  if (colon != std::string_view::npos && uri.find_first_of("/\\") > colon) return paths;
  const std::string_view bare = uri.substr(0, uri.find_first_of("?#"));
  for (const std::string& name : {percent_decoded(uri), slashed(percent_decoded(uri)), percent_decoded(bare),
                                  slashed(percent_decoded(bare))}) {
    const std::filesystem::path path = std::filesystem::path(name).lexically_normal();
    const bool usable = !name.empty() && name.find('\0') == std::string::npos;
    if (usable && std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
  }
  return paths;
}

// ---- The document

namespace {

constexpr std::size_t kGlbHeader = 12;
constexpr std::size_t kChunkHeader = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

std::uint32_t load_u32(std::string_view text, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(text[at + i])) << (8 * i);
  }
  return value;
}

// A file may make this many bytes of one of its own, or kMostUnpacked where that is more.
constexpr std::uint64_t kMostUnpackedPerByte = 64;
constexpr std::uint64_t kMostUnpacked = std::uint64_t{1} << 28;

// Returns the Debian package that kdray was built without, where shapes need it; empty where nothing is
// missing.
std::string package_for(std::string_view extension) {
  if (extension == "KHR_draco_mesh_compression" && !has_draco()) return "libdraco-dev";
  const bool meshopt = extension == "EXT_meshopt_compression" || extension == "KHR_meshopt_compression";
  return meshopt && !has_meshopt() ? "libmeshoptimizer-dev" : "";
}

}  // namespace

Document::Document(std::string_view text, const std::filesystem::path& path)
    : text_(text), json_text_(text), path_(path), file_(path.string()), bytes_read_(text.size()) {
  if (text.starts_with("glTF")) {
    split_glb();
  } else if (format_of(path) == ".glb" && !text.starts_with("{")) {
    throw input_error(file_, 0, "not a GLB file: it does not begin with 'glTF'",
                      "is it damaged or misnamed?");
  }
  if (json_text_.starts_with("\xef\xbb\xbf")) json_text_.remove_prefix(3);
  json_ = parse_json(json_text_, file_);
  check_asset();
  check_extensions();
  note_files();
}

// Records all files that this one names, in extensions too: pictures and buffers are read only when they are
// used.
void Document::note_files() const {
  std::vector<const nlohmann::json*> open = {&json_};
  while (!open.empty()) {
    const nlohmann::json& value = *open.back();
    open.pop_back();
    for (const auto& [key, member] : value.items()) {
      if (member.is_structured()) open.push_back(&member);
      if (key != "uri" || !value.is_object() || !member.is_string()) continue;
      const std::string& uri = member.get_ref<const std::string&>();
      if (!uri.starts_with("data:")) FilesRead::add_named(path_, percent_decoded(uri));
    }
  }
}

void Document::split_glb() {
  const auto fault = [&](const std::string& what) { return input_error(file_, 0, what, "export it again"); };
  if (text_.size() < kGlbHeader + kChunkHeader) throw fault("too short for a GLB file");
  const std::uint32_t version = load_u32(text_, 4);
  if (version != 2) throw fault("a GLB file of version " + std::to_string(version) + ", not 2");
  const std::size_t length = load_u32(text_, 8);
  if (length < kGlbHeader + kChunkHeader || length > text_.size()) {
    throw fault("the GLB header says " + std::to_string(length) + " bytes, but the file has " +
                std::to_string(text_.size()));
  }
  std::size_t at = kGlbHeader;
  for (int i = 0; at < length && text_.size() - at >= kChunkHeader; ++i) {
    const std::size_t size = load_u32(text_, at);
    const std::uint32_t type = load_u32(text_, at + 4);
    at += kChunkHeader;
    if (size > text_.size() - at) {
      throw fault("chunk " + std::to_string(i) + " says " + std::to_string(size) + " bytes, but " +
                  std::to_string(text_.size() - at) + " are left");
    }
    if (i == 0 && type != kJsonChunk) throw fault("the first chunk is not JSON");
    if (i == 0) json_text_ = text_.substr(at, size);
    if (type == kBinaryChunk && !binary_chunk_) binary_chunk_ = text_.substr(at, size);
    at += size;  // the padding is counted in
  }
  if (length < text_.size() && at < text_.size())
    warnings_.push_back(std::to_string(text_.size() - at) + " bytes behind the " + std::to_string(length) +
                        " that the GLB header says are left out");
}

void Document::check_asset() {
  const JsonNode asset = root()["asset"];
  const std::string version = asset["version"].string();
  if (!version.starts_with("2.")) {
    throw asset["version"].error("glTF '" + printable(version) + "' is not read",
                                 "convert the file to glTF 2.0");
  }
  const auto least = asset.find("minVersion");
  if (least && least->string() != "2.0") throw least->error("needs glTF " + printable(least->string()));
}

// A file that requires what is not read is read without it, and left_out_of() says so: only where its shapes
// are packed by what this kdray can't unpack there is nothing to show.
void Document::check_extensions() const {
  const auto required = root().find("extensionsRequired");
  if (!required) return;
  for (const JsonNode& node : required->elements()) {
    const std::string name = node.string(), package = package_for(name);
    if (package.empty()) continue;
    throw node.error("the file needs the extension " + name + ", which this kdray was built without",
                     "build it with " + package + " installed, or export the file without mesh compression");
  }
}

const std::vector<JsonNode>& Document::entries(const std::string& array) {
  const auto [it, added] = arrays_.try_emplace(array);
  if (added) {
    if (const auto node = root().find(array)) it->second = node->elements();
  }
  return it->second;
}

const JsonNode& Document::entry(const std::string& array, const JsonNode& index) {
  const auto& all = entries(array);
  const std::uint64_t i = whole(index);
  if (i >= all.size()) {
    throw index.error("there is no " + std::to_string(i) + " in /" + array + " (it has " +
                      std::to_string(all.size()) + ")");
  }
  return all[i];
}

std::string_view Document::view_bytes(const JsonNode& view) {
  const auto packed = meshopt_of(view);
  if (!packed || (!has_meshopt() && has_bytes(view["buffer"]))) return slice(view);
  if (!has_meshopt()) throw no_meshopt(*packed);
  const auto found = unpacked_views_.find(view.id());
  if (found != unpacked_views_.end()) return found->second;
  const std::string_view bytes = slice(*packed);
  count_unpacked(meshopt_size(view, *packed, bytes.size()), *packed);
  return unpacked_views_[view.id()] = unpack_meshopt(*packed, bytes);
}

void Document::count_unpacked(std::uint64_t n, const JsonNode& packed) {
  bytes_unpacked_ += n;
  if (bytes_unpacked_ <= std::max(kMostUnpacked, kMostUnpackedPerByte * bytes_read_)) return;
  throw packed.error("the file is unpacked to more than " + std::to_string(kMostUnpackedPerByte) +
                         " times what was read of it",
                     "export it without mesh compression");
}

const Unpacked* Document::unpacked(const JsonNode& accessor) const {
  const auto found = unpacked_.find(accessor.id());
  return found == unpacked_.end() ? nullptr : &found->second;
}

// Returns the bytes of a buffer view, or of what an extension has in the place of one.
std::string_view Document::slice(const JsonNode& view) {
  const std::string_view buffer = buffer_bytes(view["buffer"]);
  const std::uint64_t offset = whole_or(view, "byteOffset", 0);
  const std::uint64_t length = whole(view["byteLength"]);
  if (offset > buffer.size() || length > buffer.size() - offset) {
    throw view.error("reaches to byte " + std::to_string(offset + length) + " of a buffer of " +
                     std::to_string(buffer.size()));
  }
  return buffer.substr(offset, length);
}

bool Document::has_bytes(const JsonNode& buffer_index) {
  return entry("buffers", buffer_index).find("uri") || (whole(buffer_index) == 0 && binary_chunk_);
}

std::string_view Document::buffer_bytes(const JsonNode& index) {
  const JsonNode& buffer = entry("buffers", index);
  const std::uint64_t length = whole(buffer["byteLength"]);
  const auto uri = buffer.find("uri");
  std::string_view bytes;
  if (uri) {
    const auto [it, added] = buffers_.try_emplace(whole(index));
    if (added) {
      it->second = read_uri(*uri);
      bytes_read_ += it->second.size();
    }
    bytes = it->second;
  } else if (whole(index) == 0 && binary_chunk_) {
    bytes = *binary_chunk_;
  } else {
    throw buffer.error("has neither a uri nor the binary chunk of a GLB file");
  }
  if (bytes.size() < length) {
    throw buffer.error("says " + std::to_string(length) + " bytes, but there are " +
                       std::to_string(bytes.size()));
  }
  return bytes.substr(0, length);
}

std::string Document::read_uri(const JsonNode& node) const {
  const std::string uri = node.string();
  if (uri.starts_with("data:")) {
    std::optional<std::string> bytes = decode_data_uri(uri);
    if (!bytes) throw node.error("not a data: URI in base64");
    return std::move(*bytes);
  }
  const std::vector<std::filesystem::path> names = paths_of(uri);
  if (names.empty()) throw node.error(outside(uri));
  bool leads_out = false;
  for (const std::filesystem::path& name : names) {
    if (!may_name(path_.parent_path(), name)) {
      leads_out = true;
      continue;
    }
    const std::filesystem::path found = find_file(path_.parent_path() / name);
    if (!found.empty()) return read_file(found);
  }
  if (leads_out) throw node.error(outside(uri), kAllowAFolder);
  throw node.error("there is no file '" + printable(uri) + "' beside the scene", "put it there");
}

std::uint64_t whole(const JsonNode& node) {
  const double v = node.number_between(0, 9007199254740992.0);
  if (v != std::floor(v)) throw node.expected("a whole number");
  return static_cast<std::uint64_t>(v);
}

std::uint64_t whole_or(const JsonNode& object, std::string_view key, std::uint64_t otherwise) {
  const auto node = object.find(key);
  return node ? whole(*node) : otherwise;
}

double number_or(const JsonNode& object, std::string_view key, double otherwise) {
  const auto node = object.find(key);
  return node ? node->number() : otherwise;
}

std::string name_of(const JsonNode& object) {
  const auto name = object.find("name");
  return name && name->is_string() ? name->string() : std::string();
}

std::optional<JsonNode> extension(const JsonNode& object, std::string_view name) {
  const auto extensions = object.find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

}  // namespace kdray::scene::gltf
