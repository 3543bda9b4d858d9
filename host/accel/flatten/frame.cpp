#include "accel/flatten/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "scene/model/frame.h"

namespace kdray::flatten {

std::string in_words(const PixelRect& part) {
  return fmt::format("{}x{}+{}+{}", part.width, part.height, part.x, part.y);
}

namespace {

constexpr int kDefaultDepth = 5, kMaxDepth = 64, kMaxSamples = 65536, kMaxSide = 65536;

int pick(int option, const std::optional<int>& setting, int fallback) {
  return option > 0 ? option : setting.value_or(fallback);
}

void check_range(const char* what, int value, int lo, int hi) {
  if (value < lo || value > hi)
    throw Error(ErrorCode::usage, fmt::format("{} is {}; it may be {} to {}", what, value, lo, hi));
}

// 0 stands for a default, and no other number does but a min_weight below 0.
void check_numbers(const RenderOptions& o) {
  check_range("the picture's width", o.width, 0, kMaxSide);
  check_range("the picture's height", o.height, 0, kMaxSide);
  check_range("depth", o.depth, 0, kMaxDepth);
  check_range("samples", o.samples, 0, kMaxSamples);
  if (!(o.adaptive_target >= 0)) throw Error(ErrorCode::usage, "adaptive_target is 0 or above");
  if (std::isnan(o.min_weight)) throw Error(ErrorCode::usage, "min_weight is not a number");
}

void check_crop(const PixelRect& crop, int width, int height) {
  const auto fits = [](int first, int n, int all) {
    return first >= 0 && n >= 1 && first < all && n <= all - first;
  };
  if (!fits(crop.x, crop.width, width) || !fits(crop.y, crop.height, height))
    throw Error(ErrorCode::usage, fmt::format("the part {} does not lie within the picture of {}x{}",
                                              in_words(crop), width, height));
}

double largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

// Returns the most light that can arrive from a light: fall-off is smallest at distance 0.
double brightest(const scene::Light& light) {
  const double color = largest(light.color);
  return color > 0 ? color / light.attenuation.x : 0;
}

void set(float (&out)[3], const dvec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

// From farther off than this, in local lengths, floats can't tell apart directions to different parts of the
// scene: an eye beyond is moved to this distance, since products of larger distances leave the range of
// float.
constexpr double kFarthestEye = 0x1p60;

dvec3 local_eye(const LocalSpace& space, const dvec3& from) {
  const dvec3 eye = space.local(from);
  if (largest_component(eye) <= kFarthestEye) return eye;
  return safe_normalize(from * 0.5 - space.center * 0.5) * kFarthestEye;
}

// A pinhole's rays go along forward + x*right + y*up, and are in focus at `focus` times that.
void set_lens(layout::Frame& f, const scene::Camera& camera, const LocalSpace& space) {
  if (!(camera.aperture > 0)) return;
  const double focus = camera.focus > 0 ? camera.focus : safe_length(camera.at - camera.from);
  f.lens_radius = static_cast<float>(space.local_length(camera.aperture / 2));
  f.lens_slope = static_cast<float>(camera.aperture / 2 / focus);
}

void set_floor(layout::Frame& f, const scene::Floor& floor, const LocalSpace& space) {
  if (!(floor.radius > 0)) return;
  set(f.floor_middle, space.local(floor.middle));
  set(f.floor_up, floor.up);
  set(f.floor_unshadowed, dvec3(floor.unshadowed));
  set(f.floor_diffuse, dvec3(floor.diffuse));
  f.floor_reflect = floor.reflect;
  f.floor_inner = static_cast<float>(space.local_length(floor.inner));
  f.floor_radius = static_cast<float>(space.local_length(floor.radius));
}

}  // namespace

RenderOptions resolved(const RenderOptions& options, const scene::RenderSettings& settings) {
  check_numbers(options);
  RenderOptions o = options;
  scene::RenderSettings sized = settings;
  scene::set_size(sized, o.width, o.height);
  o.width = sized.width.value_or(scene::kDefaultSide);
  o.height = sized.height.value_or(scene::kDefaultSide);
  o.depth = pick(o.depth, settings.depth, kDefaultDepth);
  o.samples = o.adaptive_target > 0 ? 1 : pick(o.samples, settings.samples, 1);
  if (!(o.min_weight >= 0)) o.min_weight = settings.min_weight.value_or(kDefaultMinWeight);
  check_range("the picture's width", o.width, 1, kMaxSide);
  check_range("the picture's height", o.height, 1, kMaxSide);
  check_range("depth", o.depth, 1, kMaxDepth);
  check_range("samples", o.samples, 1, kMaxSamples);
  check_range("the tile's width", o.tile_width, 0, kMaxSide);
  check_range("the tile's height", o.tile_height, 0, kMaxSide);
  if (static_cast<double>(o.width) * o.height > 0x7fffffff)
    throw Error(ErrorCode::usage, fmt::format("a picture of {}x{} has over 2^31 pixels", o.width, o.height));
  if (o.crop) check_crop(*o.crop, o.width, o.height);
  return o;
}

double radiance_bound(const scene::Scene& scene, int depth) {
  double incident = 0;
  for (const scene::Light& light : scene.lights) incident += brightest(light);
  const bool sky = scene.sky.kind != scene::SkyKind::none;
  double shown = sky ? scene.sky.brightest : largest(scene.background), passed = 0;
  for (const scene::Material& m : scene.materials) {
    // Base colours are 1 at most; what blending takes from a term it passes on.
    const scene::MaterialMaps maps = m.maps == scene::kNone
                                         ? scene::MaterialMaps{}
                                         : scene::largest_terms(scene.texturing.material_maps[m.maps]);
    const double lit = largest(m.diffuse + maps.diffuse) + largest(m.specular + maps.specular);
    shown = std::max(shown, largest(m.emission + maps.emission) +
                                largest(m.ambient + maps.ambient) * largest(scene.ambient) +
                                (lit > 0 ? incident * lit : 0));
    const double sent = largest(m.reflect + maps.reflect) + largest(m.transmit + maps.transmit);
    passed = std::max(passed, maps.mode == scene::Alpha::blend ? std::max(sent, 1.0) : sent);
  }
  if (const scene::Floor& floor = scene.framing.floor; floor.radius > 0) {
    shown = std::max(shown, largest(floor.unshadowed) + incident * largest(floor.diffuse));
    passed = std::max<double>(passed, floor.reflect);
  }
  double sum = 0, share = 1;
  for (int d = 0; d < depth; ++d, share *= passed) sum += share;
  return shown * sum;
}

layout::Frame make_frame(const scene::Scene& scene, const scene::Geometry& geometry, const RenderOptions& o) {
  const scene::Camera camera = scene.camera.value_or(scene::Camera{});
  const dvec3 forward = safe_normalize(camera.at - camera.from);
  const dvec3 right =
      glm::normalize(glm::cross(forward, camera.up * scale_to_one(largest_component(camera.up))));
  const dvec3 up = glm::cross(right, forward);
  const bool parallel = camera.ortho_width > 0;
  const double half_height = parallel
                                 ? geometry.space.local_length(camera.ortho_width) / 2 * o.height / o.width
                                 : std::tan(camera.vertical_fov / 2);
  const double half_width = half_height * o.width / o.height;
  // The outermost samples of the corner grid lie on the picture's edges; with one pixel there is only one
  // corner.
  const bool corners = o.grid == PixelGrid::corners;
  const double columns = std::max(1, o.width - (corners ? 1 : 0)),
               rows = std::max(1, o.height - (corners ? 1 : 0));

  layout::Frame f{};
  set(f.eye, local_eye(geometry.space, camera.from));
  set(f.forward, forward);
  set(f.right, right);
  set(f.up, up);
  set(f.background, dvec3(scene.background));
  f.hither = static_cast<float>(geometry.space.local_length(camera.hither));
  f.x_scale = static_cast<float>(2 * half_width / columns);
  f.x_offset = static_cast<float>(-half_width);
  f.y_scale = static_cast<float>(-2 * half_height / rows);
  f.y_offset = static_cast<float>(half_height);
  set(f.root_lo, dvec3(geometry.bounds.lo));
  set(f.root_hi, dvec3(geometry.bounds.hi));
  for (int k = 0; k < 3; ++k)
    if (!geometry.bounds.empty())
      f.world_max = std::max({f.world_max, std::abs(f.root_lo[k]), std::abs(f.root_hi[k])});
  // Without a finite bound the picture's own is left: a PNG shows nothing beyond 1.
  const double bound = radiance_bound(scene, o.depth);
  f.spawn_threshold =
      bound > 0 ? static_cast<float>(o.min_weight / (std::isfinite(bound) ? bound : 1.0)) : 0.0f;
  f.keep_weightless = o.min_weight == 0 ? 1 : 0;
  const PixelRect part = o.crop.value_or(PixelRect{0, 0, o.width, o.height});
  f.width = static_cast<layout::u32>(part.width);
  f.height = static_cast<layout::u32>(part.height);
  f.crop_x = static_cast<layout::u32>(part.x);
  f.crop_y = static_cast<layout::u32>(part.y);
  f.whole_width = static_cast<layout::u32>(o.width);
  f.n_samples = static_cast<layout::u32>(o.samples);
  f.max_depth = static_cast<layout::u32>(o.depth);
  f.n_lights = static_cast<layout::u32>(scene.lights.size());
  f.corner_grid = corners ? 1 : 0;
  f.parallel = parallel ? 1 : 0;
  // The samples of a pixel share it.
  f.ray_cone = static_cast<float>(
      std::sqrt(std::abs(double{f.x_scale} * double{f.y_scale}) / static_cast<double>(o.samples)));
  set_lens(f, camera, geometry.space);
  f.has_sky = scene.sky.kind != scene::SkyKind::none ? 1 : 0;
  set_floor(f, scene.framing.floor, geometry.space);
  return f;
}

}  // namespace kdray::flatten
