#include "scene/textures/picture_limit.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "scene/textures/mipmaps.h"

namespace kdray::scene {

namespace {

// How a picture is shown.
struct Use {
  bool shown = false, curved = true;
  bool mipmaps[2] = {false, false};  // of linear colours, of codes
};

std::vector<Use> uses_of(const Texturing& texturing) {
  std::vector<Use> uses(texturing.pictures.size());
  for (const Texture& t : texturing.textures) {
    Use& use = uses[t.picture];
    if (!use.shown) use.curved = t.curved;
    use.shown = true;
    if (has_mipmaps(t.minify)) use.mipmaps[t.curved ? 1 : 0] = true;
  }
  return uses;
}

std::uint64_t bytes_of(LevelSize size, const Use& use) {
  if (!use.shown) return 0;
  std::uint64_t with = 0;
  for (const LevelSize& level : level_sizes(size.width, size.height)) with += 4 * level.texels();
  const std::uint64_t n = (use.mipmaps[0] ? 1u : 0u) + (use.mipmaps[1] ? 1u : 0u);
  return n > 0 ? n * with : 4 * size.texels();
}

// The mipmap of that level as a picture.
std::shared_ptr<const Picture> reduced(const Picture& picture, bool curved, std::size_t level,
                                       LevelSize size) {
  std::vector<std::uint32_t> words(size.texels());
  write_levels(picture, curved, level, 1, words);
  Picture out = blank_picture(picture.name, size.width, size.height);
  std::memcpy(out.texels.data(), words.data(), out.texels.size());
  return std::make_shared<const Picture>(std::move(out));
}

}  // namespace

std::uint64_t picture_bytes(const Texturing& texturing) {
  const std::vector<Use> uses = uses_of(texturing);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < uses.size(); ++i)
    sum += bytes_of({texturing.pictures[i]->width, texturing.pictures[i]->height}, uses[i]);
  return sum;
}

LimitedPictures limit_pictures(Texturing& texturing, std::uint64_t most_bytes) {
  LimitedPictures out;
  out.bytes = out.bytes_before = picture_bytes(texturing);
  if (out.bytes <= most_bytes) return out;
  const std::vector<Use> uses = uses_of(texturing);
  std::vector<std::vector<LevelSize>> sizes;
  for (const auto& picture : texturing.pictures)
    sizes.push_back(level_sizes(picture->width, picture->height));
  std::vector<std::size_t> level(uses.size(), 0);
  const auto size_of = [&](std::size_t i) {
    return level[i] + 1 < sizes[i].size() && uses[i].shown ? sizes[i][level[i]].texels() : 0;
  };
  while (out.bytes > most_bytes) {
    std::size_t largest = 0;
    for (std::size_t i = 1; i < uses.size(); ++i)
      if (size_of(i) > size_of(largest)) largest = i;
    if (size_of(largest) == 0) break;
    out.bytes -= bytes_of(sizes[largest][level[largest]], uses[largest]);
    out.bytes += bytes_of(sizes[largest][++level[largest]], uses[largest]);
  }
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (level[i] == 0) continue;
    ++out.n_halved;
    texturing.pictures[i] = reduced(*texturing.pictures[i], uses[i].curved, level[i], sizes[i][level[i]]);
  }
  return out;
}

}  // namespace kdray::scene
