#include "bench/accuracy/reference.h"

#include <nlohmann/json.hpp>

#include "bench/accuracy/shown.h"
#include "io/image/compare.h"

namespace kdray::bench {

namespace {

constexpr int kDepth = 16;

}  // namespace

Reference make_reference(Renderer& renderer, int width, int height, int samples, Precision precision) {
  Reference r;
  const auto render = [&](int scale, int n) {
    RenderOptions o;
    o.width = scale * width, o.height = scale * height;
    o.samples = n, o.depth = kDepth, o.min_weight = 0;
    o.precision = precision;
    o.mode = Mode::pdprt;
    image::Image image = image_of(renderer.render(o));
    r.seconds += renderer.statistics().seconds.render;
    return image;
  };
  const image::Image one = shrunk(render(2, samples / 8), 2), other = shrunk(render(4, samples / 32), 4);
  r.image = shown(mean_of(one, other));
  r.own_error = image::compare(shown(one), shown(other)).rmse / 2;
  return r;
}

}  // namespace kdray::bench
