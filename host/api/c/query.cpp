// The questions of kdray.h, and its pictures.
#include <cmath>

#include "api/c/boundary.h"

namespace kdray::capi {

namespace {

Rays rays_of(const kdray_rays* given) {
  const kdray_rays r = grown(needed(given, "rays"), "rays");
  return {view_of<Points>(r.origins, "rays.origins"), view_of<Points>(r.directions, "rays.directions"),
          view_of<Values>(r.t_min, "rays.t_min"), view_of<Values>(r.t_max, "rays.t_max"),
          view_of<Words>(r.masks, "rays.masks")};
}

template <class Options>
Options with(const kdray_query_options& o, Options options) {
  if (o.invalid_miss != 0) options.invalid = InvalidRays::miss;
  if (o.cancel != nullptr) options.cancel = o.cancel->cancel;
  return options;
}

PointOptions point_options(const kdray_query_options& o) {
  PointOptions options = with(o, PointOptions());
  if (o.radius != 0) options.radius = o.radius;
  return options;
}

// Runs ask(scene, options as they were given), which returns a report.
template <class Ask>
kdray_status asked(const kdray_scene* scene, const kdray_query_options* given, const Ask& ask) {
  return guarded([&] {
    const kdray_query_options o = grown(given, "options");
    const QueryReport report = ask(needed(scene, "scene")->scene, o);
    if (o.n_invalid != nullptr) *o.n_invalid = report.invalid;
  });
}

}  // namespace

}  // namespace kdray::capi

using namespace kdray;
using namespace kdray::capi;

kdray_status kdray_cancel_new(kdray_cancel** cancel) {
  return guarded([&] { *needed(cancel, "cancel") = new kdray_cancel; });
}
void kdray_cancel_now(kdray_cancel* cancel) {
  if (cancel != nullptr) cancel->cancel.cancel();
}
void kdray_cancel_free(kdray_cancel* cancel) {
  delete cancel;
}

kdray_status kdray_closest(const kdray_scene* scene, const kdray_rays* rays, const kdray_hits* hits,
                           const kdray_query_options* options) {
  return asked(scene, options, [&](const Scene& s, const kdray_query_options& o) {
    const kdray_hits h = grown(needed(hits, "hits"), "hits");
    const HitsOut out{view_of<ValuesOut>(h.t, "hits.t"),
                      view_of<WordsOut>(h.geometry, "hits.geometry"),
                      view_of<WordsOut>(h.primitive, "hits.primitive"),
                      view_of<ValuesOut>(h.u, "hits.u"),
                      view_of<ValuesOut>(h.v, "hits.v"),
                      view_of<PointsOut>(h.normal, "hits.normal"),
                      view_of<PointsOut>(h.point, "hits.point"),
                      view_of<WordsOut>(h.instance, "hits.instance")};
    return s.closest(rays_of(rays), out, with(o, QueryOptions()));
  });
}
kdray_status kdray_any(const kdray_scene* scene, const kdray_rays* rays, kdray_out hit,
                       const kdray_query_options* options) {
  return asked(scene, options, [&](const Scene& s, const kdray_query_options& o) {
    return s.any(rays_of(rays), view_of<BytesOut>(hit, "hit"), with(o, QueryOptions()));
  });
}
kdray_status kdray_count(const kdray_scene* scene, const kdray_rays* rays, kdray_out counts,
                         const kdray_query_options* options) {
  return asked(scene, options, [&](const Scene& s, const kdray_query_options& o) {
    return s.count(rays_of(rays), view_of<WordsOut>(counts, "counts"), with(o, QueryOptions()));
  });
}

kdray_status kdray_all(const kdray_scene* scene, const kdray_rays* rays, uint32_t max_hits,
                       const kdray_query_options* options, kdray_all_hits** hits) {
  return asked(scene, options, [&](const Scene& s, const kdray_query_options& o) {
    needed(hits, "hits");
    AllHitsOptions all = with(o, AllHitsOptions());
    if (max_hits > 0) all.max_hits = max_hits;
    *hits = new kdray_all_hits{s.all(rays_of(rays), all)};
    return (*hits)->hits.report;
  });
}
kdray_status kdray_all_hits_get(const kdray_all_hits* hits, kdray_all_hits_view* view) {
  return guarded([&] {
    const AllHits& h = needed(hits, "hits")->hits;
    const std::size_t size = std::min(needed(view, "view")->size, sizeof *view);
    if (size < sizeof(std::size_t)) refuse("view: its size is not set");
    const kdray_all_hits_view whole{view->size,        h.more.size(),      h.splits.data(), h.t.data(),
                                    h.geometry.data(), h.primitive.data(), h.u.data(),      h.v.data(),
                                    h.more.data(),     h.instance.data()};
    std::memcpy(view, &whole, size);
  });
}
void kdray_all_hits_free(kdray_all_hits* hits) {
  delete hits;
}

kdray_status kdray_closest_points(const kdray_scene* scene, kdray_in points,
                                  const kdray_closest_points_out* given, const kdray_query_options* options) {
  return asked(scene, options, [&](const Scene& s, const kdray_query_options& o) {
    const kdray_closest_points_out p = grown(needed(given, "out"), "out");
    const ClosestPointsOut out{view_of<ValuesOut>(p.distance, "out.distance"),
                               view_of<PointsOut>(p.point, "out.point"),
                               view_of<WordsOut>(p.geometry, "out.geometry"),
                               view_of<WordsOut>(p.primitive, "out.primitive"),
                               view_of<ValuesOut>(p.u, "out.u"),
                               view_of<ValuesOut>(p.v, "out.v"),
                               view_of<WordsOut>(p.instance, "out.instance")};
    return s.closest_points(view_of<Points>(points, "points"), out, point_options(o));
  });
}
kdray_status kdray_inside(const kdray_scene* scene, kdray_in points, kdray_out inside,
                          const kdray_query_options* options) {
  return asked(scene, options, [&](const Scene& s, const kdray_query_options& o) {
    return s.inside(view_of<Points>(points, "points"), view_of<BytesOut>(inside, "inside"), point_options(o));
  });
}
kdray_status kdray_signed_distance(const kdray_scene* scene, kdray_in points, kdray_out distance,
                                   const kdray_query_options* options) {
  return asked(scene, options, [&](const Scene& s, const kdray_query_options& o) {
    return s.signed_distance(view_of<Points>(points, "points"), view_of<ValuesOut>(distance, "distance"),
                             point_options(o));
  });
}

kdray_status kdray_render(const kdray_scene* scene, const kdray_picture_options* given, float* rgb,
                          size_t n_values) {
  return guarded([&] {
    const kdray_picture_options o = grown(given, "options");
    const Scene& asked_of = needed(scene, "scene")->scene;
    needed(rgb, "rgb");
    if (o.width < 0 || o.height < 0) refuse("options: the picture's size is below 0");
    RenderOptions options;
    options.width = o.width > 0 ? o.width : 1024;
    options.height = o.height > 0 ? o.height : 1024;
    options.samples = o.samples;
    options.depth = o.depth;
    if (o.camera != nullptr) options.camera = camera_of(o.camera);
    if (o.cancel != nullptr) options.cancel = o.cancel->cancel;
    const auto wanted =
        3 * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
    if (n_values != wanted)
      refuse("rgb: there are " + std::to_string(n_values) + " values for a picture of " +
             std::to_string(wanted));
    const Picture picture = asked_of.render(options);
    std::copy(picture.rgb.begin(), picture.rgb.end(), rgb);
  });
}
