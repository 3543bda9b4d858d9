// What can be asked of a scene. Results go into arrays that Python made, but for those whose size is not
//         known
// before.
#include <nanobind/stl/optional.h>

#include "arrays.h"
#include "interrupt.h"
#include "parts.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;
using namespace nb::literals;

template <class Options>
Options options_of(bool strict) {
  Options options;
  options.invalid = strict ? InvalidRays::error : InvalidRays::miss;
  options.cancel = cancel_on_signals();
  return options;
}

Rays rays_of(const In& origins, const In& directions, const In& t_min, const In& t_max, const In& masks) {
  return {points_of(origins), points_of(directions), values_of(t_min), values_of(t_max), words_of(masks)};
}

nb::tuple arrays_of(AllHits&& hits) {
  return nb::make_tuple(owned(std::move(hits.splits)), owned(std::move(hits.t)),
                        owned(std::move(hits.geometry)), owned(std::move(hits.primitive)),
                        owned(std::move(hits.u)), owned(std::move(hits.v)), owned(std::move(hits.more)),
                        owned(std::move(hits.instance)));
}

void add_ray_queries(SceneClass& scene) {
  scene.def(
      "closest",
      [](const Scene& s, const In& origins, const In& directions, const In& t_min, const In& t_max,
         const In& masks, bool strict, const Out& t, const Out& geometry, const Out& primitive, const Out& u,
         const Out& v, const Out& normal, const Out& point, const Out& instance) {
        const HitsOut out{values_out(t), words_out(geometry), words_out(primitive), values_out(u),
                          values_out(v), points_out(normal),  points_out(point),    words_out(instance)};
        return s
            .closest(rays_of(origins, directions, t_min, t_max, masks), out, options_of<QueryOptions>(strict))
            .invalid;
      },
      Released(), "origins"_a, "directions"_a, "t_min"_a.none(), "t_max"_a.none(), "masks"_a.none(),
      "strict"_a, "t"_a.none(), "geometry"_a.none(), "primitive"_a.none(), "u"_a.none(), "v"_a.none(),
      "normal"_a.none(), "point"_a.none(), "instance"_a.none() = nb::none());
  scene.def(
      "any",
      [](const Scene& s, const In& origins, const In& directions, const In& t_min, const In& t_max,
         const In& masks, bool strict, const Out& out) {
        return s
            .any(rays_of(origins, directions, t_min, t_max, masks), bytes_out(out),
                 options_of<QueryOptions>(strict))
            .invalid;
      },
      Released(), "origins"_a, "directions"_a, "t_min"_a.none(), "t_max"_a.none(), "masks"_a.none(),
      "strict"_a, "out"_a);
  scene.def(
      "count",
      [](const Scene& s, const In& origins, const In& directions, const In& t_min, const In& t_max,
         const In& masks, bool strict, const Out& out) {
        return s
            .count(rays_of(origins, directions, t_min, t_max, masks), words_out(out),
                   options_of<QueryOptions>(strict))
            .invalid;
      },
      Released(), "origins"_a, "directions"_a, "t_min"_a.none(), "t_max"_a.none(), "masks"_a.none(),
      "strict"_a, "out"_a);
  scene.def(
      "all",
      [](const Scene& s, const In& origins, const In& directions, const In& t_min, const In& t_max,
         const In& masks, bool strict, std::uint32_t max_hits) {
        AllHits hits;
        {
          const WithoutGil released;
          AllHitsOptions options{options_of<QueryOptions>(strict)};
          options.max_hits = max_hits;
          hits = s.all(rays_of(origins, directions, t_min, t_max, masks), options);
        }
        return arrays_of(std::move(hits));
      },
      "origins"_a, "directions"_a, "t_min"_a.none(), "t_max"_a.none(), "masks"_a.none(), "strict"_a,
      "max_hits"_a);
}

void add_point_queries(SceneClass& scene) {
  scene.def(
      "closest_points",
      [](const Scene& s, const In& points, double radius, bool strict, const Out& distance, const Out& point,
         const Out& geometry, const Out& primitive, const Out& u, const Out& v, const Out& instance) {
        PointOptions options = options_of<PointOptions>(strict);
        options.radius = radius;
        const ClosestPointsOut out{values_out(distance), points_out(point), words_out(geometry),
                                   words_out(primitive), values_out(u),     values_out(v),
                                   words_out(instance)};
        return s.closest_points(points_of(points), out, options).invalid;
      },
      Released(), "points"_a, "radius"_a, "strict"_a, "distance"_a.none(), "point"_a.none(),
      "geometry"_a.none(), "primitive"_a.none(), "u"_a.none(), "v"_a.none(),
      "instance"_a.none() = nb::none());
  scene.def(
      "inside",
      [](const Scene& s, const In& points, bool strict, const Out& out) {
        return s.inside(points_of(points), bytes_out(out), options_of<PointOptions>(strict)).invalid;
      },
      Released());
  scene.def(
      "signed_distance",
      [](const Scene& s, const In& points, double radius, bool strict, const Out& out) {
        PointOptions options = options_of<PointOptions>(strict);
        options.radius = radius;
        return s.signed_distance(points_of(points), values_out(out), options).invalid;
      },
      Released());
}

}  // namespace

void add_queries(SceneClass scene) {
  add_ray_queries(scene);
  add_point_queries(scene);
}

}  // namespace kdray::python
