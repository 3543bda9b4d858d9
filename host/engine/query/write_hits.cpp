#include "engine/query/write_hits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/query/surface.h"

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

// Whether u and v lie side by side, pair after pair.
bool are_pairs(const HitsOut& out) {
  const float* const u = out.u.first_of<float>();
  return u != nullptr && out.v.first_of<float>() == u + 1 && out.u.stride() == 2 * sizeof(float) &&
         out.v.stride() == 2 * sizeof(float);
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
  float *u, *v, *uv;  // uv: both, pair after pair

  explicit DenseColumns(const HitsOut& out)
      : t(out.t.first_of<float>()),
        geometry(out.geometry.first_of<std::uint32_t>()),
        primitive(out.primitive.first_of<std::uint32_t>()),
        u(are_pairs(out) ? nullptr : out.u.first_of<float>()),
        v(are_pairs(out) ? nullptr : out.v.first_of<float>()),
        uv(are_pairs(out) ? out.u.first_of<float>() : nullptr) {}

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
    put_four(uv, 2 * at, __builtin_shufflevector(uv01, uv01, 0, 2, 1, 3));
    put_four(uv, 2 * at + 4, __builtin_shufflevector(uv23, uv23, 0, 2, 1, 3));
  }
};
static_assert(kNoPrimitive == 0xffffffffu);

}  // namespace

HitWriter::HitWriter(const QueryContext& context, const RayArrays& rays, const HitsOut& out)
    : context_(&context), rays_(&rays), out_(out) {
  const std::size_t n = rays.size();
  check_out(out.t.size(), n, "t");
  check_out(out.geometry.size(), n, "geometry");
  check_out(out.primitive.size(), n, "primitive");
  check_out(out.u.size(), n, "u");
  check_out(out.v.size(), n, "v");
  check_out(out.normal.size(), n, "normal");
  check_out(out.point.size(), n, "point");
  check_out(out.instance.size(), n, "instance");
  if (rays.in_double()) exact_.emplace(context, rays);
  const double unit = context.frame.unit();
  dense_ = is_dense<float>(out.t) && is_dense<std::uint32_t>(out.geometry) &&
           is_dense<std::uint32_t>(out.primitive) &&
           ((is_dense<float>(out.u) && is_dense<float>(out.v)) || are_pairs(out)) && context.table.only() &&
           unit >= std::numeric_limits<float>::min() && unit <= std::numeric_limits<float>::max();
}

void HitWriter::write(std::size_t first, std::size_t begin, std::size_t end, const FoundHits& found,
                      const LocalRays& local) const {
  Changed changed;
  for (; begin < end; begin += kRows) {
    const FoundHits part = found.part(begin, std::min(kRows, end - begin));
    Some some{first + begin, begin, part.hits, part.instances, local};
    if (exact_) settle(some, changed);
    if (wants_refs()) name(some, changed);
    write_columns(some, write_dense(some));
  }
}

// Looks at the hits of rays of doubles in double.
void HitWriter::settle(Some& some, Changed& changed) const {
  for (std::size_t i = 0; i < some.hits.size(); ++i) {
    constexpr ExactHit kMiss{HUGE_VAL, 0, 0, kNoPrimitive, kNoInstance};
    const QueryHit& hit = some.hits[i];
    std::optional<ExactHit> found;
    if (!missed(hit))
      found = {hit.t, hit.u, hit.v, static_cast<std::uint32_t>(hit.primitive), some.instance(i)};
    const ExactHit exact = exact_->closest(some.ray + i, found).value_or(kMiss);
    changed.hits[i] = {static_cast<float>(exact.t), static_cast<std::int32_t>(exact.ref),
                       static_cast<float>(exact.u), static_cast<float>(exact.v)};
    changed.instances[i] = exact.instance;
    changed.t[i] = exact.t;
  }
  some.hits = std::span(changed.hits).first(some.hits.size());
  if (!some.instances.empty()) some.instances = std::span(changed.instances).first(some.hits.size());
  some.t = std::span(changed.t).first(some.hits.size());
}

// Of a hit that is named by a reference, which gets its number.
dvec3 HitWriter::normal_of(const Some& some, std::size_t i, QueryHit& hit) const {
  const flatten::FlatScene& flat = context_->scene().flat;
  const std::uint32_t index = some.instance(i);
  const layout::Instance* const instance = index == kNoInstance ? nullptr : &flat.instances[index];
  const auto point = [&] {
    const dvec3 local = context_->frame.space().local(point_of(some.ray + i, some.t_of(i, hit)));
    return instance ? in_mesh(*instance, local) : local;
  };
  const Surface surface = surface_at(flat, static_cast<std::uint32_t>(hit.primitive), point);
  hit.primitive = static_cast<std::int32_t>(surface.number);
  return instance ? normal_in_scene(*instance, surface.normal) : surface.normal;
}

// Names hits by their numbers, which are named by references, and writes their normals.
void HitWriter::name(Some& some, Changed& changed) const {
  const std::size_t n = some.hits.size();
  if (out_.normal.empty()) {
    for (std::size_t i = 0; i < n; ++i) {
      QueryHit& hit = changed.hits[i] = some.hits[i];
      if (!missed(hit))
        hit.primitive = static_cast<std::int32_t>(
            number_of(context_->scene().flat, static_cast<std::uint32_t>(hit.primitive)));
    }
  }
  fill(out_.normal, some, 0, [&](std::size_t i, QueryHit hit) {
    const dvec3 normal = missed(hit) ? dvec3(0) : normal_of(some, i, hit);
    changed.hits[i] = hit;
    return array(normal);
  });
  some.hits = std::span(changed.hits).first(n);
}

// How many of them were written.
std::size_t HitWriter::write_dense(const Some& some) const {
  if (!dense_ || some.local.has_moved() || exact_) return 0;
  const DenseColumns columns(out_);
  const auto unit = static_cast<float>(context_->frame.unit());
  const GeometryId id = *context_->table.only();
  std::size_t i = 0;
  for (; i + 4 <= some.hits.size(); i += 4) columns.put(some.ray + i, &some.hits[i], unit, id);
  return i;
}

template <class Column, class ValueOf>
void HitWriter::fill(const Column& column, const Some& some, std::size_t from,
                     const ValueOf& value_of) const {
  if (column.empty()) return;
  column.fill(some.ray + from, some.hits.size() - from, [&](std::size_t ray) {
    const std::size_t i = ray - some.ray;
    return value_of(i, some.hits[i]);
  });
}

// Those from `from` on.
void HitWriter::write_columns(const Some& some, std::size_t from) const {
  const auto place_of = [&](std::size_t i, const QueryHit& hit) {
    if (missed(hit)) return GeometryTable::Place{kNoGeometry, kNoPrimitive};
    const std::uint32_t index = some.instance(i);
    return context_->table.of(
        static_cast<std::uint32_t>(hit.primitive),
        index == kNoInstance ? kNoInstance : context_->scene().flat.instances[index].number);
  };
  fill(out_.t, some, from, [&](std::size_t i, const auto& hit) { return std::array{some.t_of(i, hit)}; });
  fill(out_.geometry, some, from,
       [&](std::size_t i, const auto& hit) { return std::array{place_of(i, hit).geometry}; });
  fill(out_.primitive, some, from,
       [&](std::size_t i, const auto& hit) { return std::array{place_of(i, hit).primitive}; });
  fill(out_.instance, some, from,
       [&](std::size_t i, const auto& hit) { return std::array{place_of(i, hit).instance}; });
  fill(out_.u, some, from, [](std::size_t, const auto& hit) { return std::array{hit.u}; });
  fill(out_.v, some, from, [](std::size_t, const auto& hit) { return std::array{hit.v}; });
  fill(out_.point, some, 0,
       [&](std::size_t i, const auto& hit) { return array(point_of(some.ray + i, some.t_of(i, hit))); });
}

dvec3 HitWriter::point_of(std::size_t ray, double t) const {
  return std::isinf(t) ? dvec3(HUGE_VAL) : rays_->origin(ray) + t * rays_->direction(ray);
}

}  // namespace kdray::query
