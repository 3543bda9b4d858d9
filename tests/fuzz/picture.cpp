// The pictures of textures, which their first bytes tell apart: PNG, JPEG, WebP.
#include "scene/textures/picture.h"

#include "fuzz/target.h"

KDRAY_FUZZ(picture, bytes) {
  using namespace kdray;
  return fuzz::is_read([&] {
    std::vector<std::string> warnings;
    const auto picture = scene::decode_picture(bytes, "a picture", warnings);
    if (picture->texels.size() != std::size_t{4} * picture->width * picture->height)
      fuzz::fail("a picture whose texels are not as many as its size says");
  });
}
