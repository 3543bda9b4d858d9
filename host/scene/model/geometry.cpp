#include "scene/model/geometry.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"

namespace kdray::scene {

namespace {

// Returns where the scene's own origin should be, along one axis. A coordinate near the origin stays as it
// is, so that the floats of a file stay the floats of the file. Otherwise the middle is taken, rounded to a
// multiple of the power of two below the scene's size: every float coordinate x of such a scene has |x| >
// size, so x - center is a multiple of ulp(x) of at most 1.5 times that power, which a float holds without
// loss.
double center_along(double lo, double hi, double size) {
  const double middle = lo + (hi - lo) * 0.5;
  if (std::abs(middle) <= 1.5 * size) return 0;
  if (!(size > 0)) return middle;  // everything is in one point
  const double step = std::ldexp(1.0, std::ilogb(size));
  const double rounded = std::round(middle / step) * step;
  return std::isfinite(rounded) ? rounded : middle;
}

dvec3 center_of(const DBox& box) {
  if (box.empty()) return dvec3(0);
  const dvec3 extent = box.extent();
  const double size = std::max({extent.x, extent.y, extent.z});
  return {center_along(box.lo.x, box.hi.x, size), center_along(box.lo.y, box.hi.y, size),
          center_along(box.lo.z, box.hi.z, size)};
}

LocalSpace space_around(const DBox& box) {
  if (box.empty()) return {};
  const dvec3 center = center_of(box);
  const double reach = std::max(largest_component(box.lo - center), largest_component(box.hi - center));
  return {center, scale_to_one(reach / kLocalReach)};
}

// Smaller than this, in local lengths, a primitive is less than the distance that rays may be moved by when
// they leave a surface (8u of its largest coordinate, docs/design/numerics.md), so that its shadow may be
// lost.
constexpr float kFine = static_cast<float>(0x1p-20 * kLocalReach);

// A share of fine primitives that is no cause for a warning: scanned meshes have a few tiny triangles among
// others, whose shadows hide theirs.
constexpr double kFewFine = 0.01;

bool is_fine(const Box& box) {
  const vec3 extent = box.extent();
  return std::max({extent.x, extent.y, extent.z}) < kFine;
}

constexpr std::size_t kGrain = std::size_t{1} << 14;

// Calls work(first, last) for grains of [0, n), in parallel.
template <class Work>
void for_each_grain(std::size_t n, const Work& work) {
  tbb::parallel_for(std::size_t{0}, (n + kGrain - 1) / kGrain,
                    [&](std::size_t grain) { work(grain * kGrain, std::min(n, (grain + 1) * kGrain)); });
}

class Maker {
 public:
  Maker(const LocalSpace& space, const Scene& scene, bool for_doubles = false)
      : scene_(scene), for_doubles_(for_doubles) {
    out_.space = space;
  }

  Geometry make() {
    add_triangles();
    primitives::for_each_shape([this](auto kind) { add_shapes(kind); });
    return std::move(out_);
  }

 private:
  vec3 local(const dvec3& p) const { return vec3(out_.space.local(p)); }

  TriangleGeometry triangle(const RawVector<vec3>& vertices, std::size_t i) const {
    const Triangle& from = scene_.triangles[i];
    TriangleGeometry t{};
    for (std::size_t v = 0; v < 3; ++v)
      for (int k = 0; k < 3; ++k) t.v[v][k] = vertices[from.vertex[v]][k];
    t.number = from.number;
    t.material = from.material;
    t.normals = KDRAY_NO_NORMALS;
    return t;
  }

  void add_triangles() {
    const RawVector<vec3> vertices = local_vertices();
    const std::size_t n = scene_.triangles.size(), n_grains = (n + kGrain - 1) / kGrain;
    std::vector<std::size_t> kept(n_grains);
    std::vector<GrainFacts> facts(n_grains);
    out_.triangles = Array<TriangleGeometry>(n);
    out_.sources.resize(n);
    for_each_grain(n, [&](std::size_t first, std::size_t last) {
      std::size_t end = first;
      GrainFacts found;
      for (std::size_t i = first; i < last; ++i) {
        TriangleGeometry t = triangle(vertices, i);
        if (is_flat(t)) {
          if (for_doubles_ && differ(scene_.triangles[i].vertex)) {
            if (!has_equal_corners(t)) mark_zero_area(t, found);
          } else {
            found.lost += has_area(i);
            if (has_equal_corners(t)) continue;
            mark_zero_area(t, found);
          }
        }
        out_.triangles[end] = t;
        out_.sources[end++] = static_cast<std::uint32_t>(i);
        const Box box = bounds_of(t);
        found.bounds.grow(box);
        found.fine += !for_doubles_ && !is_zero_area(t) && is_fine(box);  // without area: no shadow to lose
      }
      kept[first / kGrain] = end - first;
      facts[first / kGrain] = found;
    });
    close_gaps(kept);
    out_.dropped_degenerate += static_cast<std::uint32_t>(n - out_.triangles.size());
    bool has_zero_area = false;
    for (const GrainFacts& found : facts) {
      out_.bounds.grow(found.bounds);
      out_.lost += found.lost;
      out_.fine += found.fine;
      has_zero_area |= found.has_zero_area;
    }
    if (has_zero_area) out_.zero_area = find_zero_area(out_.triangles);
    if (has_zero_area || !scene_.normals.empty()) number_normals();
  }

  // What is known of a grain of triangles, and added up afterwards.
  struct GrainFacts {
    Box bounds;
    std::uint32_t lost = 0, fine = 0;
    bool has_zero_area = false;
  };

  static void mark_zero_area(TriangleGeometry& t, GrainFacts& found) {
    t.normals |= KDRAY_ZERO_AREA;
    found.has_zero_area = true;
  }

  bool differ(const std::array<std::uint32_t, 3>& v) const {
    const dvec3 &a = scene_.vertices[v[0]], &b = scene_.vertices[v[1]], &c = scene_.vertices[v[2]];
    return a != b && b != c && c != a;
  }

  bool has_area(std::size_t i) const {
    const auto& v = scene_.triangles[i].vertex;
    const dvec3 &a = scene_.vertices[v[0]], b = scene_.vertices[v[1]] - a, c = scene_.vertices[v[2]] - a;
    const double scale = scale_to_one(std::max(largest_component(b), largest_component(c)));
    return scene::has_area(b * scale, c * scale);
  }

  // Moves together the triangles that each grain kept at its beginning.
  void close_gaps(const std::vector<std::size_t>& kept) {
    std::size_t end = 0;
    for (std::size_t grain = 0; grain < kept.size(); ++grain) {
      const std::size_t from = grain * kGrain, n = kept[grain];
      if (from != end) {
        std::copy_n(out_.triangles.begin() + from, n, out_.triangles.begin() + end);
        std::copy_n(out_.sources.begin() + static_cast<std::ptrdiff_t>(from), n,
                    out_.sources.begin() + static_cast<std::ptrdiff_t>(end));
      }
      end += n;
    }
    out_.triangles = Array<TriangleGeometry>(out_.triangles.owner(), out_.triangles.data(), end);
    out_.sources.resize(end);
  }

  bool has_normals(std::size_t i) const {
    return is_zero_area(out_.triangles[i]) || scene_.triangles[out_.sources[i]].normal[0] != kNone;
  }

  void number_normals() {
    const std::size_t n = out_.triangles.size();
    std::vector<std::uint32_t> before((n + kGrain - 1) / kGrain + 1, 0);  // those of earlier grains
    for_each_grain(n, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) before[first / kGrain + 1] += has_normals(i) ? 1 : 0;
    });
    std::partial_sum(before.begin(), before.end(), before.begin());
    for_each_grain(n, [&](std::size_t first, std::size_t last) {
      std::uint32_t next = before[first / kGrain];
      for (std::size_t i = first; i < last; ++i) {
        if (!has_normals(i)) continue;
        layout::u32& normals = out_.triangles[i].normals;
        normals = (normals & KDRAY_ZERO_AREA) | next++;
      }
    });
    out_.n_smooth = before.back();
  }

  RawVector<vec3> local_vertices() const {
    RawVector<vec3> vertices(scene_.vertices.size());
    for_each_grain(vertices.size(), [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) vertices[i] = local(scene_.vertices[i]);
    });
    return vertices;
  }

  template <class Kind>
  void add_shapes(Kind) {
    const auto& shapes = Kind::of(scene_);
    auto& kept = Kind::of(out_);
    kept.reserve(shapes.size());
    for (std::uint32_t i = 0; i < shapes.size(); ++i) {
      typename Kind::Geometry shape = geometry_of(shapes[i], out_.space, i);
      if constexpr (requires { keep_height(shape, shapes[i]); })
        if (for_doubles_) keep_height(shape, shapes[i]);
      if (!primitives::has_area(shape)) {
        ++out_.dropped_degenerate;
        ++out_.lost;  // the file's have a radius, and a height
        continue;
      }
      kept.push_back(shape);
      const Box box = bounds_of(shape);
      out_.bounds.grow(box);
      out_.fine += !for_doubles_ && is_fine(box);
    }
  }

  const Scene& scene_;
  bool for_doubles_;
  Geometry out_;
};

}  // namespace

LocalSpace space_of(const DBox& bounds, const std::string& name) {
  if (!bounds.empty() && !is_finite(bounds.extent()))
    throw input_error(name, 0, "coordinates beyond the range of double precision (1.8e308)",
                      "scale the scene down");
  return space_around(bounds);
}

Geometry make_geometry_in(const LocalSpace& space, const Scene& scene) {
  return Maker(space, scene).make();
}

Geometry make_geometry_for_doubles(const Scene& scene) {
  return Maker(space_of(scene.bounds(), scene.name), scene, true).make();
}

bool fits_floats(const Scene& scene, const LocalSpace& space) {
  return std::ranges::all_of(scene.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t.vertex, [&](std::uint32_t v) {
      const dvec3 local = space.local(scene.vertices[v]);
      return dvec3(vec3(local)) == local;
    });
  });
}

namespace {

dvec3 local_in_doubles(const LocalSpace& space, const dvec3& world) {
  dvec3 local = space.local(world);
  for (int k = 0; k < 3; ++k)
    if (std::abs(local[k]) < DoubleGeometry::kLeast) local[k] = 0;
  return local;
}

template <class Shape>
Shape local_in_doubles(const LocalSpace& space, Shape shape) {
  const auto bring = [&](const auto& field) {
    auto& value = shape.*field.member;
    if constexpr (std::is_same_v<decltype(shape.*field.member), double&>)
      value = space.local_length(value);
    else if (field.meaning == primitives::Meaning::direction)
      value *= scale_to_one(largest_component(value));
    else
      value = local_in_doubles(space, value);
  };
  std::apply([&](const auto&... fields) { (bring(fields), ...); },
             fields_of(static_cast<const Shape*>(nullptr)));
  return shape;
}

}  // namespace

std::size_t DoubleGeometry::n_shapes() const {
  std::size_t n = 0;
  primitives::for_each_shape([&](auto kind) { n += decltype(kind)::of(*this).size(); });
  return n;
}

DoubleGeometry make_double_geometry(const Scene& scene, const Geometry& geometry) {
  DoubleGeometry made;
  made.vertices.resize(scene.vertices.size());
  for_each_grain(made.vertices.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      made.vertices[i] = local_in_doubles(geometry.space, scene.vertices[i]);
  });
  made.corners.resize(geometry.triangles.size());
  for_each_grain(made.corners.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) made.corners[i] = scene.triangles[geometry.sources[i]].vertex;
  });
  primitives::for_each_shape([&](auto kind) {
    using Kind = decltype(kind);
    auto& shapes = Kind::of(made);
    shapes.reserve(Kind::of(geometry).size());
    for (const auto& of_floats : Kind::of(geometry)) {
      const auto& shape =
          shapes.emplace_back(local_in_doubles(geometry.space, Kind::of(scene)[of_floats.source]));
      if constexpr (requires { apart(shape, of_floats); })
        made.apart = std::max(made.apart, apart(shape, of_floats));
    }
  });
  return made;
}

Geometry make_geometry(const Scene& scene, const std::optional<LocalSpace>& kept) {
  const DBox bounds = scene.bounds();
  const LocalSpace own = space_of(bounds, scene.name);
  return make_geometry_in(kept && keeps_space(*kept, bounds) ? *kept : own, scene);
}

bool keeps_space(const LocalSpace& space, const DBox& bounds) {
  if (bounds.empty()) return false;
  const double reach =
      std::max(largest_component(space.local(bounds.lo)), largest_component(space.local(bounds.hi)));
  return reach >= 0.5 * kLocalReach && reach < 4 * kLocalReach;
}

std::string range_warning(const Geometry& geometry) {
  return range_warning(geometry.lost, geometry.fine, geometry.size());
}

std::string range_warning(std::size_t lost, std::size_t fine, std::size_t kept) {
  const bool many = static_cast<double>(fine) > kFewFine * static_cast<double>(kept);
  if (lost == 0 && !many) return "";
  std::string what;
  if (lost > 0) what = fmt::format("{} of the primitives are too small for it to see", lost);
  if (many)
    what += fmt::format("{}{} primitives are smaller than a millionth of it, and may lose their shadows",
                        what.empty() ? "" : " and ", fine);
  return "the scene ranges wider than single precision: " + what +
         "; take out what lies far off, or what is huge, split the scene, or ask about it in double geometry";
}

Box bounds_of(const TriangleGeometry& t) {
  Box box;
  for (int i = 0; i < 3; ++i) box.grow(vertex(t, i));
  return box;
}

}  // namespace kdray::scene
