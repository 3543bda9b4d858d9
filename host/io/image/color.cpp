#include "io/image/color.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"

namespace kdray::image {

void check(const Transfer& transfer) {
  if (!transfer.srgb && !(transfer.gamma > 0 && std::isfinite(transfer.gamma)))
    throw Error(ErrorCode::usage, "gamma must be a positive number; 1 is linear, 2.2 a common screen");
}

double encode(const Transfer& transfer, double linear) {
  if (!transfer.srgb) return transfer.gamma == 1 ? linear : std::pow(linear, 1 / transfer.gamma);
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double decode(const Transfer& transfer, double display) {
  if (!transfer.srgb) return transfer.gamma == 1 ? display : std::pow(display, transfer.gamma);
  return display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4);
}

Quantizer::Quantizer(const Transfer& transfer, std::uint32_t maximum)
    : maximum_(maximum), begin_(maximum), bucket_code_(kBuckets + 1) {
  check(transfer);
  for (std::uint32_t code = 0; code < maximum; ++code) {
    const double exact = decode(transfer, (code + 0.5) / maximum);
    // It is rounded up, since the first float at or above the exact boundary is the first that gets the next
    // code.
    const float rounded = static_cast<float>(exact);
    begin_[code] =
        rounded < exact ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
  }
  std::uint32_t code = 0;
  for (std::uint32_t b = 0; b <= kBuckets; ++b) {
    while (code < maximum && begin_[code] <= static_cast<float>(b) / kBuckets) ++code;
    bucket_code_[b] = code;
  }
}

std::uint32_t Quantizer::operator()(float linear) const {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return maximum_;
  const auto bucket = static_cast<std::uint32_t>(linear * kBuckets);  // exact: kBuckets is a power of two
  const float* first = begin_.data() + bucket_code_[bucket];
  const float* last = begin_.data() + bucket_code_[bucket + 1];
  return static_cast<std::uint32_t>(std::upper_bound(first, last, linear) - begin_.data());
}

vec3 heat(double share) {
  // Display values at equal steps, interpolated linearly as the eye sees them.
  static constexpr std::array<std::array<double, 3>, 6> kStops = {{{0, 0, 0},
                                                                   {0.20, 0.06, 0.48},
                                                                   {0.60, 0.14, 0.52},
                                                                   {0.90, 0.32, 0.36},
                                                                   {0.99, 0.65, 0.35},
                                                                   {0.99, 0.99, 0.80}}};
  const double position = (share > 0 ? std::min(share, 1.0) : 0.0) * (kStops.size() - 1);
  const std::size_t below = std::min<std::size_t>(static_cast<std::size_t>(position), kStops.size() - 2);
  const double part = position - static_cast<double>(below);
  const Transfer srgb{};
  vec3 color;
  for (int c = 0; c < 3; ++c)
    color[c] =
        static_cast<float>(decode(srgb, kStops[below][c] + part * (kStops[below + 1][c] - kStops[below][c])));
  return color;
}

namespace {

constexpr std::array<std::array<std::uint8_t, 3>, 7> kFirst = {{{230, 159, 0},
                                                                {86, 180, 233},
                                                                {0, 158, 115},
                                                                {204, 121, 167},
                                                                {240, 228, 66},
                                                                {0, 114, 178},
                                                                {213, 94, 0}}};

// Returns the colour of a hue from 0 to 1, `chroma` away from grey.
std::array<std::uint8_t, 3> of_hue(double hue, double chroma, double brightness) {
  std::array<std::uint8_t, 3> color{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double from_peak =
        std::abs(std::fmod(hue + static_cast<double>(k) / 3, 1.0) - 0.5) * 6;  // 0 at the channel's peak
    const double share = std::clamp(2 - from_peak, 0.0, 1.0);
    color[k] = static_cast<std::uint8_t>(std::lround(255 * brightness * (1 - chroma * (1 - share))));
  }
  return color;
}

}  // namespace

std::array<std::uint8_t, 3> queue_color(std::size_t queue) {
  if (queue < kFirst.size()) return kFirst[queue];
  // Steps of the golden section never come back to where they were, and neighbours are far apart.
  constexpr double kGoldenSection = 0.6180339887498949;
  const double number = static_cast<double>(queue - kFirst.size());
  return of_hue(std::fmod(number * kGoldenSection, 1.0), queue % 2 == 0 ? 0.55 : 0.85,
                queue % 3 == 0 ? 0.75 : 0.95);
}

namespace {

constexpr std::string_view kNamed =
    " aliceblue:f0f8ff antiquewhite:faebd7 aqua:00ffff aquamarine:7fffd4 azure:f0ffff beige:f5f5dc"
    " bisque:ffe4c4 black:000000 blanchedalmond:ffebcd blue:0000ff blueviolet:8a2be2 brown:a52a2a"
    " burlywood:deb887 cadetblue:5f9ea0 chartreuse:7fff00 chocolate:d2691e coral:ff7f50"
    " cornflowerblue:6495ed cornsilk:fff8dc crimson:dc143c cyan:00ffff darkblue:00008b darkcyan:008b8b"
    " darkgoldenrod:b8860b darkgray:a9a9a9 darkgreen:006400 darkgrey:a9a9a9 darkkhaki:bdb76b"
    " darkmagenta:8b008b darkolivegreen:556b2f darkorange:ff8c00 darkorchid:9932cc darkred:8b0000"
    " darksalmon:e9967a darkseagreen:8fbc8f darkslateblue:483d8b darkslategray:2f4f4f darkslategrey:2f4f4f"
    " darkturquoise:00ced1 darkviolet:9400d3 deeppink:ff1493 deepskyblue:00bfff dimgray:696969"
    " dimgrey:696969 dodgerblue:1e90ff firebrick:b22222 floralwhite:fffaf0 forestgreen:228b22"
    " fuchsia:ff00ff gainsboro:dcdcdc ghostwhite:f8f8ff gold:ffd700 goldenrod:daa520 gray:808080"
    " green:008000 greenyellow:adff2f grey:808080 honeydew:f0fff0 hotpink:ff69b4 indianred:cd5c5c"
    " indigo:4b0082 ivory:fffff0 khaki:f0e68c lavender:e6e6fa lavenderblush:fff0f5 lawngreen:7cfc00"
    " lemonchiffon:fffacd lightblue:add8e6 lightcoral:f08080 lightcyan:e0ffff lightgoldenrodyellow:fafad2"
    " lightgray:d3d3d3 lightgreen:90ee90 lightgrey:d3d3d3 lightpink:ffb6c1 lightsalmon:ffa07a"
    " lightseagreen:20b2aa lightskyblue:87cefa lightslategray:778899 lightslategrey:778899"
    " lightsteelblue:b0c4de lightyellow:ffffe0 lime:00ff00 limegreen:32cd32 linen:faf0e6 magenta:ff00ff"
    " maroon:800000 mediumaquamarine:66cdaa mediumblue:0000cd mediumorchid:ba55d3 mediumpurple:9370db"
    " mediumseagreen:3cb371 mediumslateblue:7b68ee mediumspringgreen:00fa9a mediumturquoise:48d1cc"
    " mediumvioletred:c71585 midnightblue:191970 mintcream:f5fffa mistyrose:ffe4e1 moccasin:ffe4b5"
    " navajowhite:ffdead navy:000080 oldlace:fdf5e6 olive:808000 olivedrab:6b8e23 orange:ffa500"
    " orangered:ff4500 orchid:da70d6 palegoldenrod:eee8aa palegreen:98fb98 paleturquoise:afeeee"
    " palevioletred:db7093 papayawhip:ffefd5 peachpuff:ffdab9 peru:cd853f pink:ffc0cb plum:dda0dd"
    " powderblue:b0e0e6 purple:800080 rebeccapurple:663399 red:ff0000 rosybrown:bc8f8f royalblue:4169e1"
    " saddlebrown:8b4513 salmon:fa8072 sandybrown:f4a460 seagreen:2e8b57 seashell:fff5ee sienna:a0522d"
    " silver:c0c0c0 skyblue:87ceeb slateblue:6a5acd slategray:708090 slategrey:708090 snow:fffafa"
    " springgreen:00ff7f steelblue:4682b4 tan:d2b48c teal:008080 thistle:d8bfd8 tomato:ff6347"
    " turquoise:40e0d0 violet:ee82ee wheat:f5deb3 white:ffffff whitesmoke:f5f5f5 yellow:ffff00"
    " yellowgreen:9acd32";
constexpr std::size_t kDigits = 6;

// "rgb" or "rrggbb"; a digit alone stands for two.
std::optional<vec3> hexadecimal(std::string_view digits) {
  std::string all(digits);
  if (digits.size() == kDigits / 2) all = {digits[0], digits[0], digits[1], digits[1], digits[2], digits[2]};
  std::uint32_t rgb = 0;
  const char* const end = all.data() + all.size();
  const auto [stopped, error] = std::from_chars(all.data(), end, rgb, 16);
  if (all.size() != kDigits || error != std::errc() || stopped != end) return std::nullopt;
  const auto channel = [rgb](unsigned shift) {
    return static_cast<float>(decode(Transfer{}, (rgb >> shift & 0xff) / 255.0));
  };
  return vec3(channel(16), channel(8), channel(0));
}

}  // namespace

std::optional<vec3> css_color(std::string_view text) {
  if (text.starts_with('#')) return hexadecimal(text.substr(1));
  std::string name = " ";
  for (const char c : text) {
    const char small = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (small < 'a' || small > 'z') return std::nullopt;
    name += small;
  }
  const std::size_t found = kNamed.find(name + ':');
  if (found == std::string_view::npos) return std::nullopt;
  return hexadecimal(kNamed.substr(found + name.size() + 1, kDigits));
}

std::vector<std::string_view> css_names() {
  std::vector<std::string_view> names;
  for (std::size_t at = 0; at < kNamed.size();) {
    const std::size_t colon = kNamed.find(':', at);
    names.push_back(kNamed.substr(at + 1, colon - at - 1));
    at = colon + 1 + kDigits;
  }
  return names;
}

}  // namespace kdray::image
