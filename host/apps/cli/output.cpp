#include "apps/cli/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/write_file.h"

namespace fs = std::filesystem;

namespace kdray::cli {

void write_text(const fs::path& file, std::string_view text) {
  if (file == "-") return print(text);
  write_file(file, text);
}

void print(std::string_view text) {
  const bool whole = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!whole || std::fflush(stdout) != 0)
    throw input_error("standard output", 0, fmt::format("can't be written ({})", std::strerror(errno)));
}

std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

fs::path default_picture(const fs::path& scene, image::PictureFormat format) {
  fs::path name = scene == "-" ? "stdin" : scene.filename();
  if (const std::string ending = ending_of(name); ending == ".gz" || ending == ".xz") name = name.stem();
  return name.replace_extension(format == image::PictureFormat::exr ? ".exr" : ".png");
}

image::Written put_picture(const fs::path& file, const image::Image& image,
                           std::span<const image::Channel> channels, const image::WriteOptions& options) {
  if (file != "-") return image::write_picture(file, image, channels, options);
  const auto format = options.format.value_or(image::PictureFormat::png);
  print(image::encode_picture(format, image, channels, options));
  return {{file}, image::count_nan(image)};
}

std::string one_line(std::string_view text) {
  std::string line;
  bool gap = false;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code <= ' ' || code == 0x7f) {  // bytes from 0x80 up are UTF-8: left alone
      gap = !line.empty();
      continue;
    }
    if (gap) line += ' ';
    gap = false;
    line += c;
  }
  return line;
}

void say(std::string_view text) {
  const std::string line = "kdray: " + one_line(text) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

bool can_redraw() {
  const char* const term = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) && term && std::string_view(term) != "dumb";
}

std::string in_words(double count) {
  static constexpr const char* kUnits[] = {"", " k", " M", " G", " T"};
  int unit = 0;
  while (std::abs(count) >= 1000 && unit < 4) count /= 1000, ++unit;
  if (unit == 0 && count == std::floor(count)) return fmt::format("{:.0f}", count);
  return fmt::format("{:.3g}{}", count, kUnits[unit]);
}

std::string seconds_in_words(double seconds) {
  if (seconds < 0.9995e-3) return fmt::format("{:.3g} us", seconds * 1e6);
  if (seconds < 0.9995) return fmt::format("{:.3g} ms", seconds * 1e3);
  if (seconds < 59.95) return fmt::format("{:.3g} s", seconds);
  const long long whole = std::llround(seconds);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string bytes_in_words(std::uint64_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  static constexpr const char* kUnits[] = {"KiB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes) / 1024;
  int unit = 0;
  while (value >= 1024 && unit < 3) value /= 1024, ++unit;
  return fmt::format("{:.4g} {}", value, kUnits[unit]);
}

}  // namespace kdray::cli
