#include "apps/verify/verify.h"

#include <algorithm>
#include <cmath>

#include "accel/prepare/instanced.h"
#include "accel/prepare/prepared.h"
#include "apps/verify/mesh.h"
#include "apps/verify/tracer.h"
#include "base/error.h"
#include "base/timer.h"

namespace kdray::verify {

namespace {

constexpr int kFilmSide = 256;

// Renders the scene's own view, small, with all that shading does, and looks for values that are no numbers.
// A render that meets one itself, or loses a ray on its stack, ends with an internal error.
Film look_through(const prepare::Prepared& prepared, const DeviceOptions& device) {
  Film film;
  Renderer renderer(PreparedScene(prepare::Prepared(prepared)), device);
  try {
    const Picture picture = renderer.render({.width = kFilmSide, .height = kFilmSide});
    film.pixels = picture.rgb.size() / 3;
    for (std::size_t i = 0; i < film.pixels; ++i) {
      const float* const rgb = picture.rgb.data() + 3 * i;
      film.not_finite += !std::all_of(rgb, rgb + 3, [](float v) { return std::isfinite(v); });
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::internal) throw;
    film.fault = error.what();
  }
  return film;
}

double take(Timer& timer) {
  const double seconds = timer.seconds();
  timer.restart();
  return seconds;
}

}  // namespace

bool Findings::mesh_is_sound() const {
  return topology.open.empty() && topology.crowded.empty() && topology.turned.empty() && dropped == 0 &&
         duplicates.doubled.empty() && duplicates.overlapping.empty();
}

bool Findings::kdray_is_sound() const {
  return probes.defects() == 0 && film.not_finite == 0 && film.fault.empty();
}

Findings verify(const scene::Scene& scene, const Options& o) {
  Findings found;
  Timer timer;
  const scene::Geometry geometry = scene::make_geometry(scene);
  found.space = geometry.space;
  found.dropped = geometry.dropped_degenerate;
  const prepare::Prepared prepared = in_local_space(prepare::prepare(scene, o.tree));
  prepare::refuse_instances(prepared, "verify");
  found.counts = prepared.counts;
  found.seconds.build = take(timer);

  found.mesh = make_mesh(scene, geometry);
  found.topology = find_topology(found.mesh);
  found.seconds.mesh = take(timer);
  const Boxes boxes(found.mesh);
  found.duplicates = find_duplicates(found.mesh, boxes);
  found.seconds.duplicates = take(timer);

  Tracer tracer(prepared, o.device);
  found.probes = probe({scene, geometry, found.mesh, boxes, found.topology}, tracer, o.rays, o.progress);
  found.seconds.probes = take(timer);
  found.film = look_through(prepared, o.device);
  found.seconds.film = take(timer);
  if (o.width > 0) found.picture = draw(found, prepared, tracer, o.width, o.height);
  found.seconds.picture = take(timer);
  return found;
}

}  // namespace kdray::verify
