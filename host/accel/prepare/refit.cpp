#include "accel/prepare/refit.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>

#include "accel/flatten/features.h"
#include "accel/flatten/refit.h"
#include "accel/flatten/textures.h"
#include "base/timer.h"

namespace kdray::prepare {

namespace {

// Returns whether the form's blocks and normals name the same triangles as before.
bool are_same(const Array<layout::Triangle>& a, const Array<layout::Triangle>& b) {
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  if (a.size() != b.size()) return false;
  const auto same = [&](const tbb::blocked_range<std::size_t>& range, bool all) {
    for (std::size_t i = range.begin(); i < range.end() && all; ++i)
      all = a[i].number == b[i].number && a[i].normals == b[i].normals && a[i].material == b[i].material;
    return all;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, a.size(), kGrain), true, same,
                              std::logical_and<>());
}

// Returns the features of the same triangles; looks at each of them only where materials have changed.
layout::Features features_of(const Prepared& last, const scene::Scene& scene,
                             const scene::Geometry& geometry) {
  return scene.materials == last.settings.materials ? flatten::features_in_light(last.features, scene)
                                                    : flatten::features_of(scene, geometry);
}

double growth_of(double now, double built) {
  return now > 0 && built > 0 ? now / built : 1;
}

}  // namespace

Fitting::Fitting(const Prepared& built) : pieces(built.wide), cost(flatten::expected_cost(built.wide)) {}

Refitted refit(const scene::Scene& scene, const Prepared& last, const Fitting& fitting, double most_growth) {
  const Timer timer;
  const scene::Geometry geometry = scene::make_geometry(scene, last.geometry.space);
  if (!(geometry.space == last.geometry.space) || !are_same(geometry.triangles, last.flat.triangles))
    return {};
  flatten::Refit fit = flatten::refit(last.wide, fitting.pieces, geometry.triangles);
  Refitted made{{}, growth_of(fit.cost, fitting.cost)};
  if (!(made.growth <= most_growth)) return made;
  Prepared& out = made.scene.emplace(last);
  out.features = features_of(last, scene, geometry);
  describe(out, scene, geometry);
  out.geometry.bounds = geometry.bounds;
  out.flat.triangles = geometry.triangles;
  out.flat.normals = flatten::pack_normals(scene, geometry);
  out.flat.materials = flatten::pack_materials(scene);
  out.flat.material_maps = flatten::pack_material_maps(scene);
  out.flat.lights = flatten::pack_lights(scene, geometry.space);
  out.flat.sky = {}, out.flat.sky_colors = {};
  flatten::pack_sky(scene.sky, out.flat);
  out.wide = std::move(fit.form);
  out.seconds = {.load = last.seconds.load, .build = 0, .flatten = timer.seconds()};
  return made;
}

}  // namespace kdray::prepare
