#include "query/write_hits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "query/surface.h"

namespace kdray::query {

namespace {

using layout::QueryHit;

bool missed(const QueryHit& hit) {
  return hit.primitive == -1;
}
std::array<double, 3> array(const dvec3& v) {
  return {v.x, v.y, v.z};
}

template <class T, class View>
bool is_dense(const View& view) {
  return view.empty() || (view.template first_of<T>() != nullptr && view.stride() == sizeof(T));
}

using Lanes = float __attribute__((vector_size(16)));
using Words = int __attribute__((vector_size(16)));

Lanes four_of(const QueryHit& hit) {
  static_assert(sizeof(QueryHit) == sizeof(Lanes));
  Lanes lanes;
  std::memcpy(&lanes, &hit, sizeof lanes);
  return lanes;
}

template <class T, class V>
void put_four(T* to, std::size_t at, const V& four) {
  if (to != nullptr) std::memcpy(to + at, &four, sizeof four);
}

// Columns without gaps; null: not wanted.
struct DenseColumns {
  float* t;
  std::uint32_t *geometry, *primitive;
  float *u, *v;

  explicit DenseColumns(const HitsOut& out)
      : t(out.t.first_of<float>()),
        geometry(out.geometry.first_of<std::uint32_t>()),
        primitive(out.primitive.first_of<std::uint32_t>()),
        u(out.u.first_of<float>()),
        v(out.v.first_of<float>()) {}

  // Four hits to the rows from `at` on; t in multiples of `unit`, hits all of one geometry.
  void put(std::size_t at, const QueryHit* hits, float unit, GeometryId id) const {
    const Lanes a = four_of(hits[0]), b = four_of(hits[1]), c = four_of(hits[2]), d = four_of(hits[3]);
    const Lanes tp01 = __builtin_shufflevector(a, b, 0, 4, 1, 5),
                tp23 = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Lanes uv01 = __builtin_shufflevector(a, b, 2, 6, 3, 7),
                uv23 = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    const Words numbers = (Words)__builtin_shufflevector(tp01, tp23, 2, 3, 6, 7);
    put_four(t, at, __builtin_shufflevector(tp01, tp23, 0, 1, 4, 5) * unit);
    put_four(primitive, at, numbers);  // of a miss -1: kNoPrimitive
    put_four(geometry, at,
             numbers == -1 ? Words{} + static_cast<int>(kNoGeometry) : Words{} + static_cast<int>(id));
    put_four(u, at, __builtin_shufflevector(uv01, uv23, 0, 1, 4, 5));
    put_four(v, at, __builtin_shufflevector(uv01, uv23, 2, 3, 6, 7));
  }
};
static_assert(kNoPrimitive == 0xffffffffu);

}  // namespace

HitWriter::HitWriter(const Asked& asked, const RayArrays& rays, const HitsOut& out)
    : asked_(&asked), rays_(&rays), out_(out) {
  const std::size_t n = rays.size();
  check_out(out.t.size(), n, "t");
  check_out(out.geometry.size(), n, "geometry");
  check_out(out.primitive.size(), n, "primitive");
  check_out(out.u.size(), n, "u");
  check_out(out.v.size(), n, "v");
  check_out(out.normal.size(), n, "normal");
  check_out(out.point.size(), n, "point");
  const double unit = asked.frame.unit();
  dense_ = is_dense<float>(out.t) && is_dense<std::uint32_t>(out.geometry) &&
           is_dense<std::uint32_t>(out.primitive) && is_dense<float>(out.u) && is_dense<float>(out.v) &&
           out.normal.empty() && out.point.empty() && asked.table.only() &&
           unit >= std::numeric_limits<float>::min() && unit <= std::numeric_limits<float>::max();
}

void HitWriter::write(std::size_t first, std::size_t begin, std::size_t end, std::span<const QueryHit> hits,
                      const LocalRays& local) const {
  if (dense_ && !local.has_moved()) {
    const DenseColumns columns(out_);
    const auto unit = static_cast<float>(asked_->frame.unit());
    for (const GeometryId id = *asked_->table.only(); begin + 4 <= end; begin += 4)
      columns.put(first + begin, &hits[begin], unit, id);
  }
  // The hits stay in the nearest cache for all columns.
  constexpr std::size_t kRows = 512;
  for (; begin < end; begin += kRows) write_columns(first, begin, std::min(end, begin + kRows), hits, local);
}

void HitWriter::write_columns(std::size_t first, std::size_t begin, std::size_t end,
                              std::span<const QueryHit> hits, const LocalRays& local) const {
  const auto fill = [&](const auto& column, const auto& value_of) {
    if (column.empty()) return;
    column.fill(first + begin, end - begin,
                [&](std::size_t ray) { return value_of(ray, hits[ray - first]); });
  };
  // The t of a miss is infinite, and stays so.
  const auto t_of = [&](std::size_t ray, const QueryHit& hit) { return local.world_t(ray - first, hit.t); };
  fill(out_.t, [&](std::size_t ray, const auto& hit) { return std::array{t_of(ray, hit)}; });
  fill(out_.geometry, [&](std::size_t, const auto& hit) { return std::array{place_of(hit).geometry}; });
  fill(out_.primitive, [&](std::size_t, const auto& hit) { return std::array{place_of(hit).primitive}; });
  fill(out_.u, [](std::size_t, const auto& hit) { return std::array{hit.u}; });
  fill(out_.v, [](std::size_t, const auto& hit) { return std::array{hit.v}; });
  fill(out_.normal, [&](std::size_t ray, const auto& hit) { return normal_of(ray, hit, t_of(ray, hit)); });
  fill(out_.point, [&](std::size_t ray, const auto& hit) { return array(point_of(ray, t_of(ray, hit))); });
}

GeometryTable::Place HitWriter::place_of(const QueryHit& hit) const {
  if (missed(hit)) return {kNoGeometry, kNoPrimitive};
  const auto word = static_cast<std::uint32_t>(hit.primitive);
  return asked_->table.of(wants_refs() ? number_of(asked_->scene().flat, word) : word);
}

dvec3 HitWriter::point_of(std::size_t ray, double t) const {
  return std::isinf(t) ? dvec3(HUGE_VAL) : rays_->origin(ray) + t * rays_->direction(ray);
}

std::array<double, 3> HitWriter::normal_of(std::size_t ray, const QueryHit& hit, double t) const {
  if (missed(hit)) return {0, 0, 0};
  return array(normal_at(asked_->scene().flat, static_cast<std::uint32_t>(hit.primitive),
                         asked_->frame.space().local(point_of(ray, t))));
}

}  // namespace kdray::query
