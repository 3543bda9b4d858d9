#include "io/image/format.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace kdray::image {

PictureFormat format_for_writing(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (ending == ".png") return PictureFormat::png;
  if (ending == ".exr") return PictureFormat::exr;
  throw input_error(file.string(), 0,
                    ending.empty() ? "the picture's name has no ending"
                                   : "pictures of the kind '" + ending + "' cannot be written",
                    "end the name in .png or .exr");
}

PictureFormat format_of_content(std::string_view bytes, const std::filesystem::path& file) {
  if (bytes.starts_with("\x89PNG")) return PictureFormat::png;
  if (bytes.starts_with("\x76\x2f\x31\x01")) return PictureFormat::exr;
  throw input_error(file.string(), 0, "is neither a PNG nor an OpenEXR picture", "name a .png or .exr file");
}

}  // namespace kdray::image
