#include "accel/flatten/sky.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/error.h"
#include "scene/primitives/pack.h"

namespace kdray::flatten {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 16;

// A base colour, and what each step between two stops adds to it.
Array<float> pack_gradient(const scene::Sky& sky) {
  const auto& stops = sky.stops;
  Array<float> out(3 + KDRAY_SKY_STEP * (stops.size() - 1));
  const auto put = [](float* to, const vec3& v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; };
  put(out.data(), stops[0].color);
  for (std::size_t i = 1; i < stops.size(); ++i) {
    float* const step = out.data() + 3 + KDRAY_SKY_STEP * (i - 1);
    step[0] = static_cast<float>(stops[i - 1].height);
    step[1] = static_cast<float>(1 / (stops[i].height - stops[i - 1].height));
    put(step + 2, stops[i].color - stops[i - 1].color);
    step[5] = 0;
  }
  return out;
}

// The film cuts contributions at its own most, so that nothing is lost where colours are cut there.
Array<float> pack_picture(const scene::Sky& sky) {
  if (!sky.picture) throw Error(ErrorCode::internal, "the sky's picture has been let go of");
  const std::vector<float>& rgb = sky.picture->rgb;
  const auto strength = static_cast<float>(sky.strength);
  Array<float> out(rgb.size());
  tbb::parallel_for(std::size_t{0}, (rgb.size() + kGrain - 1) / kGrain, [&](std::size_t grain) {
    for (std::size_t i = grain * kGrain; i < std::min(rgb.size(), (grain + 1) * kGrain); ++i)
      out[i] = std::min(rgb[i] * strength, KDRAY_SKY_MOST);
  });
  return out;
}

}  // namespace

void pack_sky(const scene::Sky& sky, FlatScene& flat) {
  if (sky.kind == scene::SkyKind::none) return;
  const bool gradient = sky.kind == scene::SkyKind::gradient;
  const scene::SkyAxes axes = scene::axes_of(sky);
  layout::Sky out{};
  primitives::set(out.right, vec3(axes.right));
  primitives::set(out.up, vec3(axes.up));
  primitives::set(out.forward, vec3(axes.forward));
  out.kind = gradient ? KDRAY_SKY_GRADIENT : KDRAY_SKY_PICTURE;
  out.width = gradient ? static_cast<layout::u32>(sky.stops.size() - 1) : sky.picture->width;
  out.height = gradient ? 1 : sky.picture->height;
  flat.sky_colors = gradient ? pack_gradient(sky) : pack_picture(sky);
  flat.sky = Array<layout::Sky>(1);
  flat.sky[0] = out;
}

}  // namespace kdray::flatten
