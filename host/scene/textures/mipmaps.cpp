#include "scene/textures/mipmaps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <vector>

namespace kdray::scene {

namespace {

using Linear = std::array<std::uint16_t, 4>;  // in 65535ths

constexpr std::size_t kTexelGrain = 16;  // rows that one task makes

// What bytes are worth, and back: the byte whose worth is nearest; of two the lower one.
struct Curve {
  std::array<std::uint16_t, 256> linear;
  std::vector<std::uint8_t> code = std::vector<std::uint8_t>(65536);

  explicit Curve(bool curved) {
    for (std::uint32_t c = 0; c < 256; ++c)
      linear[c] = static_cast<std::uint16_t>(curved ? linear_unit_of_srgb(c / 255.0) : c * 257);
    std::uint32_t c = 0;
    for (std::uint32_t v = 0; v < 65536; ++v) {
      while (c < 255 && linear[c + 1] - v < v - linear[c] && v > linear[c]) ++c;
      code[v] = static_cast<std::uint8_t>(c);
    }
  }
};

const Curve& curve_of(bool curved) {
  static const Curve srgb(true), even(false);
  return curved ? srgb : even;
}

// What a texel covers of the level before, along one axis: from `first` on with these weights, which add up
// to the number of texels there.
struct Cover {
  std::uint32_t first = 0, n = 0;
  std::array<std::uint32_t, 3> weights{};
};

std::vector<Cover> covers(std::uint32_t from, std::uint32_t to) {
  std::vector<Cover> all(to);
  for (std::uint64_t i = 0; i < to; ++i) {
    Cover& c = all[i];
    c.first = static_cast<std::uint32_t>(i * from / to);
    for (std::uint64_t j = c.first; j * to < (i + 1) * from; ++j)
      c.weights[c.n++] =
          static_cast<std::uint32_t>(std::min((i + 1) * from, (j + 1) * to) - std::max(i * from, j * to));
  }
  return all;
}

// texel_at(x, y) of a level of size `from` -> the level after it.
template <class TexelAt>
std::vector<Linear> halved(LevelSize from, LevelSize to, const TexelAt& texel_at) {
  const std::vector<Cover> columns = covers(from.width, to.width), rows = covers(from.height, to.height);
  const std::uint64_t all = from.texels();
  std::vector<Linear> out(to.texels());
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, to.height, kTexelGrain), [&](const auto& range) {
    for (std::uint32_t y = range.begin(); y < range.end(); ++y)
      for (std::uint32_t x = 0; x < to.width; ++x) {
        std::array<std::uint64_t, 4> sum{all / 2, all / 2, all / 2, all / 2};
        for (std::uint32_t j = 0; j < rows[y].n; ++j)
          for (std::uint32_t i = 0; i < columns[x].n; ++i) {
            const std::uint64_t weight = std::uint64_t{rows[y].weights[j]} * columns[x].weights[i];
            const Linear texel = texel_at(columns[x].first + i, rows[y].first + j);
            for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * texel[c];
          }
        for (std::size_t c = 0; c < 4; ++c)
          out[std::size_t{y} * to.width + x][c] = static_cast<std::uint16_t>(sum[c] / all);
      }
  });
  return out;
}

std::uint32_t word_of(const Linear& texel, const Curve& color, const Curve& even) {
  return color.code[texel[0]] | std::uint32_t{color.code[texel[1]]} << 8 |
         std::uint32_t{color.code[texel[2]]} << 16 | std::uint32_t{even.code[texel[3]]} << 24;
}

}  // namespace

std::vector<LevelSize> level_sizes(std::uint32_t width, std::uint32_t height) {
  std::vector<LevelSize> sizes{{width, height}};
  while (width > 1 || height > 1) {
    width = std::max(width / 2, 1u);
    height = std::max(height / 2, 1u);
    sizes.push_back({width, height});
  }
  return sizes;
}

void write_levels(const Picture& picture, bool curved, std::size_t first_level, std::size_t n_levels,
                  std::span<std::uint32_t> out) {
  const std::vector<LevelSize> sizes = level_sizes(picture.width, picture.height);
  const Curve &color = curve_of(curved), &even = curve_of(false);
  std::size_t place = 0;
  if (first_level == 0) {
    // Bytes in this order are words of a little-endian machine, as every one with an OpenCL device is.
    std::memcpy(out.data(), picture.texels.data(), picture.texels.size());
    place = sizes[0].texels();
  }
  std::vector<Linear> level;
  for (std::size_t k = 1; k < first_level + n_levels; ++k) {
    if (k == 1) {
      level = halved(sizes[0], sizes[1], [&](std::uint32_t x, std::uint32_t y) {
        const std::uint8_t* b = picture.texels.data() + 4 * (std::size_t{y} * picture.width + x);
        return Linear{color.linear[b[0]], color.linear[b[1]], color.linear[b[2]], even.linear[b[3]]};
      });
    } else {
      level = halved(sizes[k - 1], sizes[k], [&](std::uint32_t x, std::uint32_t y) {
        return level[std::size_t{y} * sizes[k - 1].width + x];
      });
    }
    if (k < first_level) continue;
    for (const Linear& texel : level) out[place++] = word_of(texel, color, even);
  }
}

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

// Returns the mipmap of that level as a picture.
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
