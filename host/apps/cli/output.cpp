#include "apps/cli/output.h"

#include <fmt/format.h>

#include <cctype>
#include <cerrno>
#include <cstdio>
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

}  // namespace kdray::cli
