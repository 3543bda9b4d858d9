#include "scene/textures/sky.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "base/error.h"
#include "base/local_space.h"
#include "io/image/exr.h"
#include "scene/import/files.h"
#include "scene/textures/picture.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

namespace {

bool is_color(const vec3& v) {
  return is_finite(dvec3(v)) && v.x >= 0 && v.y >= 0 && v.z >= 0;
}

const char* fault_of_stops(const Sky& sky) {
  constexpr double kLeastStep = 1e-6;
  if (sky.stops.empty()) return "a gradient without stops";
  for (std::size_t i = 0; i < sky.stops.size(); ++i) {
    const SkyStop& stop = sky.stops[i];
    if (!(stop.height >= -1 && stop.height <= 1)) return "a stop's height is not from -1 to 1";
    if (!is_color(stop.color)) return "a stop's colour is not finite, or below 0";
    if (i > 0 && !(stop.height - sky.stops[i - 1].height >= kLeastStep))
      return "the stops' heights don't ascend, by a millionth each";
  }
  return nullptr;
}

}  // namespace

SkyAxes axes_of(const Sky& sky) {
  // The direction at right angles to `up` that is nearest to forward; where there is none, along y.
  const dvec3 wanted = std::abs(sky.up.z) > 0.999999 ? dvec3(0, 1, 0) : dvec3(0, 0, -1);
  const dvec3 ahead = glm::normalize(wanted - sky.up * glm::dot(wanted, sky.up));
  const dvec3 aside = glm::cross(ahead, sky.up);
  // Turned right-handed about `up`, what was ahead goes to the left.
  const double c = std::cos(sky.turn), s = std::sin(sky.turn);
  return {.right = aside * c + ahead * s, .up = sky.up, .forward = ahead * c - aside * s};
}

double brightest_of(const Sky& sky) {
  double most = sky.picture ? sky.picture->brightest * sky.strength : 0;
  for (const SkyStop& stop : sky.stops)
    most = std::max<double>({most, stop.color.x, stop.color.y, stop.color.z});
  return most;
}

const char* fault_of(const Sky& sky) {
  if (sky.kind == SkyKind::none) return nullptr;
  if (!(std::abs(glm::length(sky.up) - 1) < 1e-6)) return "the sky's 'up' has no unit length";
  if (sky.kind == SkyKind::gradient) return fault_of_stops(sky);
  if (!std::isfinite(sky.turn)) return "the sky's turn is not finite";
  if (!(sky.strength >= 0 && sky.strength <= 1e6)) return "the sky's strength is not from 0 to 1e6";
  return nullptr;
}

// ---- Radiance's pictures (.hdr, .pic): a header of lines, then for each row from the top its pixels as
// mantissas of red, green and blue with one exponent, run-length coded in one of two ways or not. The rows
// are read as they come, so that a header which promises too much fails early. G. Ward, "Real pixels",
// Graphics Gems II; Radiance's src/common/color.c says how runs are coded. A mantissa m with the exponent e
// is m * 2^(e - 136).

namespace {

// Refuses what has no texels or too many.
void check_sky_size(std::uint64_t width, std::uint64_t height, const std::string& name) {
  if (width == 0 || height == 0) throw input_error(name, 0, "a picture without pixels", "write it again");
  if (width <= kLongestSide && height <= kLongestSide && width * height <= kMostTexels) return;
  throw input_error(name, 0,
                    "a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                        " pixels; a background has " + std::to_string(kMostTexels) +
                        " at most, and no side over " + std::to_string(kLongestSide),
                    "make it smaller");
}

using Rgbe = std::array<std::uint8_t, 4>;

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {}

  std::string_view line() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos || end > kLongestLine) fail("has no end of its header");
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
  }
  std::uint8_t byte() {
    if (rest_.empty()) fail("is cut short");
    const auto b = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return b;
  }
  Rgbe four() { return {byte(), byte(), byte(), byte()}; }

  [[noreturn]] void fail(const std::string& why) const {
    throw input_error(name_, 0, "is a damaged Radiance picture: it " + why, "write it again");
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const {
    throw input_error(name_, 0, what, remedy);
  }

 private:
  static constexpr std::size_t kLongestLine = 4096;

  std::string_view rest_;
  const std::string& name_;
};

struct Header {
  std::uint64_t width = 0, height = 0;
  double exposure = 1;  // that the pixels have been multiplied by
};

// "-Y 512 +X 1024": from the top, from the left.
bool take_size(std::string_view line, Header& header) {
  const auto take = [&line](std::string_view axis, std::uint64_t& side) {
    if (!line.starts_with(axis)) return false;
    line.remove_prefix(axis.size());
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), side);
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    return error == std::errc();
  };
  return take("-Y ", header.height) && take(" +X ", header.width) && line.empty();
}

void take_exposure(std::string_view value, Header& header, const Reader& reader) {
  while (value.starts_with(' ')) value.remove_prefix(1);
  double exposure = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), exposure);
  header.exposure *= exposure;
  if (error != std::errc() || !(header.exposure > 0) || !std::isfinite(header.exposure))
    reader.fail("has an exposure that is no number above 0");
}

Header read_header(Reader& reader) {
  Header header;
  (void)reader.line();  // "#?RADIANCE"
  for (std::string_view line = reader.line(); !line.empty(); line = reader.line()) {
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      reader.refuse("is a Radiance picture of the format '" + std::string(line.substr(7)) + "'",
                    "convert it to 32-bit_rle_rgbe");
    if (line.starts_with("EXPOSURE=")) take_exposure(line.substr(9), header, reader);
  }
  const std::string_view size = reader.line();
  if (!take_size(size, header))
    reader.refuse("is a Radiance picture whose rows lie as '" + std::string(size.substr(0, 60)) + "'",
                  "write it as '-Y HEIGHT +X WIDTH'");
  return header;
}

// Each of the four bytes for itself: runs, and stretches of bytes as they are.
void read_coded_row(Reader& reader, std::vector<Rgbe>& row) {
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t x = 0; x < row.size();) {
      const std::uint8_t code = reader.byte();
      const bool run = code > 128;
      const std::size_t n = run ? code - 128u : code;
      if (n == 0 || n > row.size() - x) reader.fail("has a run beyond its row");
      std::uint8_t value = run ? reader.byte() : 0;
      for (std::size_t i = 0; i < n; ++i) row[x++][c] = run ? value : value = reader.byte();
    }
}

// Pixels as they are, but for (1, 1, 1, n), which repeats the last one n times; several in a row are the
// bytes of one count, the lowest first.
void read_plain_row(Reader& reader, const Rgbe& first, std::vector<Rgbe>& row) {
  Rgbe pixel = first;
  unsigned shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const bool repeats = pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1;
    if (repeats) {
      if (x == 0 || shift > 16) reader.fail("repeats a pixel that isn't there");
      const std::size_t n = std::size_t{pixel[3]} << shift;
      if (n > row.size() - x) reader.fail("has a run beyond its row");
      for (std::size_t i = 0; i < n; ++i, ++x) row[x] = row[x - 1];
      shift += 8;
    } else {
      row[x++] = pixel;
      shift = 0;
    }
    if (x < row.size()) pixel = reader.four();
  }
}

void read_row(Reader& reader, std::vector<Rgbe>& row) {
  constexpr std::size_t kLeastCoded = 8, kMostCoded = 0x7fff;
  const Rgbe first = reader.four();
  const bool coded = row.size() >= kLeastCoded && row.size() <= kMostCoded && first[0] == 2 &&
                     first[1] == 2 && first[2] < 128;
  if (!coded) return read_plain_row(reader, first, row);
  if ((std::size_t{first[2]} << 8 | first[3]) != row.size()) reader.fail("has a row of another width");
  read_coded_row(reader, row);
}

SkyPicture decode_radiance(std::string_view bytes, const std::string& name) {
  Reader reader(bytes, name);
  const Header header = read_header(reader);
  check_sky_size(header.width, header.height, name);
  SkyPicture picture{
      name, static_cast<std::uint32_t>(header.width), static_cast<std::uint32_t>(header.height), {}};
  std::vector<Rgbe> row(picture.width);
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    read_row(reader, row);
    for (const Rgbe& pixel : row) {
      const double one = pixel[3] == 0 ? 0 : std::ldexp(1.0, pixel[3] - 136) / header.exposure;
      const double unit = std::min(one, 3e38);  // an exposure may be next to 0
      for (std::size_t c = 0; c < 3; ++c)
        picture.rgb.push_back(static_cast<float>(std::min(pixel[c] * unit, 3e38)));
    }
  }
  return picture;
}

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
  constexpr std::uint32_t kSmall = 16;  // where it matters little: a few pixels of colours
  const std::int64_t off = std::int64_t{sky.width} - 2 * std::int64_t{sky.height};
  if (sky.height >= kSmall && std::abs(off) > sky.height / 10)
    warnings.push_back(
        fmt::format("{}: is {}x{}; a picture all around is twice as wide as high, so that this "
                    "one is stretched",
                    name, sky.width, sky.height));
  sky.brightest = sky.rgb.empty() ? 0 : *std::max_element(sky.rgb.begin(), sky.rgb.end());
  return std::make_shared<const SkyPicture>(std::move(sky));
}

std::shared_ptr<const SkyPicture> read_sky_picture(const std::filesystem::path& file,
                                                   std::vector<std::string>& warnings) {
  return decode_sky_picture(read_file(file), file.string(), warnings);
}

}  // namespace kdray::scene
