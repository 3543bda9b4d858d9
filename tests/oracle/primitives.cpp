#include "oracle/primitives.h"

#include <algorithm>

namespace kdray::oracle {

World::World(const scene::Scene& scene) : scene_(scene) {
  DBox box;
  primitives::for_each_kind([&](auto kind) {
    std::uint32_t source = 0;
    for (const auto& p : decltype(kind)::of(scene)) {
      if (std::optional<Shape> shape = shape_of(scene, p, box)) {
        shape->kind = kind.kKind, shape->source = source, shape->number = static_cast<int>(p.number);
        shapes_.push_back(*shape);
      }
      ++source;
    }
  });
  std::sort(shapes_.begin(), shapes_.end(),
            [](const Shape& l, const Shape& r) { return l.number < r.number; });
  if (!box.empty()) extent_ = 0.5 * std::max({box.extent().x, box.extent().y, box.extent().z});
}

namespace {

Hit intersect(const Shape& shape, const Ray& ray, double grow) {
  return primitives::with_kind(static_cast<std::uint32_t>(shape.kind),
                               [&](auto kind) { return intersect(kind, shape, ray, grow); });
}

}  // namespace

Hit World::closest(const Ray& ray, double grow) const {
  Hit best;
  Ray rest = ray;  // as far as the nearest hit yet
  for (const Shape& shape : shapes_) {
    const Hit hit = intersect(shape, rest, grow);
    if (!hit.found() || hit.t >= best.t) continue;  // ascending numbers: on a tie the smaller one stays
    best = hit;
    rest.t_max = hit.t;
  }
  return best;
}

bool World::occluded(const Ray& ray) const {
  return std::any_of(shapes_.begin(), shapes_.end(), [&](const Shape& shape) {
    const Hit hit = intersect(shape, ray, 0);
    return hit.found() && hit.t > ray.t_min && hit.t < ray.t_max;
  });
}

Surface World::surface(const Ray& ray, const Hit& hit) const {
  const auto found = std::lower_bound(shapes_.begin(), shapes_.end(), hit.primitive,
                                      [](const Shape& s, int number) { return s.number < number; });
  Surface out;
  out.point = ray.origin + hit.t * ray.direction;
  primitives::with_kind(static_cast<std::uint32_t>(found->kind), [&](auto kind) {
    out.material = decltype(kind)::of(scene_)[found->source].material;
    put_surface(kind, scene_, *found, hit, out);
  });
  if (!out.smooth) out.shading = out.outward;
  return out;
}

}  // namespace kdray::oracle
