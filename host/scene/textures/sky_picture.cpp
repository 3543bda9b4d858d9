#include "scene/textures/sky_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "io/image/exr.h"
#include "scene/import/read_file.h"
#include "scene/textures/picture.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

namespace {

SkyPicture decode_eight_bits(std::string_view bytes, const std::string& name,
                             std::vector<std::string>& warnings) {
  const std::shared_ptr<const Picture> picture = decode_picture(bytes, name, warnings);
  std::array<float, 256> curve{};
  for (std::size_t code = 0; code < curve.size(); ++code)
    curve[code] = static_cast<float>(linear_unit_of_srgb(static_cast<double>(code) / 255)) / 65535.0f;
  SkyPicture sky{name, picture->width, picture->height, {}};
  sky.rgb.resize(std::size_t{3} * sky.width * sky.height);
  for (std::size_t i = 0; i < sky.rgb.size(); ++i) sky.rgb[i] = curve[picture->texels[i / 3 * 4 + i % 3]];
  return sky;
}

SkyPicture decode_exr_sky(std::string_view bytes, const std::string& name,
                          std::vector<std::string>& warnings) {
  const image::Image image = image::decode_exr(bytes, name, kMostTexels);
  SkyPicture sky{name, static_cast<std::uint32_t>(image.width), static_cast<std::uint32_t>(image.height), {}};
  check_sky_size(sky.width, sky.height, name);
  sky.rgb.reserve(3 * image.pixels.size());
  std::size_t bad = 0;
  for (const vec3& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) {
      const bool good = std::isfinite(pixel[c]) && pixel[c] >= 0;
      sky.rgb.push_back(good ? pixel[c] : 0.0f);
      bad += good ? 0 : 1;
    }
  if (bad > 0)
    warnings.push_back(name + ": " + std::to_string(bad) +
                       " values are below 0, infinite or no numbers; they count as 0");
  return sky;
}

}  // namespace

void check_sky_size(std::uint64_t width, std::uint64_t height, const std::string& name) {
  if (width == 0 || height == 0) throw input_error(name, 0, "a picture without pixels", "write it again");
  if (width <= kLongestSide && height <= kLongestSide && width * height <= kMostTexels) return;
  throw input_error(name, 0,
                    "a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                        " pixels; a background has " + std::to_string(kMostTexels) +
                        " at most, and no side over " + std::to_string(kLongestSide),
                    "make it smaller");
}

std::shared_ptr<const SkyPicture> decode_sky_picture(std::string_view bytes, const std::string& name,
                                                     std::vector<std::string>& warnings) {
  SkyPicture sky;
  if (bytes.starts_with("#?")) {
    sky = decode_radiance(bytes, name);
  } else if (bytes.starts_with("\x76\x2f\x31\x01")) {
    sky = decode_exr_sky(bytes, name, warnings);
  } else if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xff\xd8")) {
    sky = decode_eight_bits(bytes, name, warnings);
  } else {
    throw input_error(name, 0, "is neither EXR, Radiance HDR, PNG nor JPEG", "convert it to one of these");
  }
  sky.brightest = sky.rgb.empty() ? 0 : *std::max_element(sky.rgb.begin(), sky.rgb.end());
  return std::make_shared<const SkyPicture>(std::move(sky));
}

std::shared_ptr<const SkyPicture> read_sky_picture(const std::filesystem::path& file,
                                                   std::vector<std::string>& warnings) {
  return decode_sky_picture(read_file(file), file.string(), warnings);
}

}  // namespace kdray::scene
