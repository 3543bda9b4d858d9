// What    Pictures of extra channels, for beside a PNG: how a depth, a normal, a primitive's number or a cost
//         looks, and which queue traced what.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/image/image.h"
#include "io/image/png.h"

namespace kdray::image {

struct ChannelPicture {
  std::string name;  // "depth", "normal", "primitive", "cost", "queue": the part between NAME. and .png
  PngPixels pixels;
  PngMeta meta;
};

// One picture per channel; the three of a normal make one. `image` is the picture beside them, whose
// brightness the colours of queues take; where it is empty they are flat.
std::vector<ChannelPicture> channel_pictures(int width, int height, std::span<const Channel> channels,
                                             std::span<const vec3> image = {});

}  // namespace kdray::image
