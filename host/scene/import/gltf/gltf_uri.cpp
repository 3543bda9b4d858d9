#include "scene/import/gltf/gltf_uri.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "scene/import/find_file.h"

namespace kdray::scene::gltf {

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

}  // namespace kdray::scene::gltf
