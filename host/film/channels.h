// What    Pictures of extra channels, for beside a PNG: how a depth, a normal, a primitive's number or a cost
//         looks.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "film/image.h"
#include "film/png.h"

namespace kdray::film {

struct ChannelPicture {
  std::string name;  // "depth", "normal", "primitive", "cost": the part between NAME. and .png
  PngPixels pixels;
  PngMeta meta;
};

// One picture per channel; the three of a normal make one.
std::vector<ChannelPicture> channel_pictures(int width, int height, std::span<const Channel> channels);

}  // namespace kdray::film
