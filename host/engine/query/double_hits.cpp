#include "engine/query/double_hits.h"

#include "base/highway_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/query/double_hits.cpp"
// First, as it includes this file for each instruction set.
#include "hwy/foreach_target.h"

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::query::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, CrossedTriangles::kLanes>;
using V = hn::Vec<D>;

// The sum of both. The low one is within some units in the last place of what the high one is a sum of, so it
// may be the larger where those cancel out. Sums and products are off by less than 2^-99 of the sizes of the
// terms that they were multiplied and added from.
// Source: Dekker 1971; Joldes, Muller, Popescu 2017.
struct Pairs {
  V high, low;

  // g++ for ARM gives constructors of its own making no instruction set.
  HWY_ATTR Pairs() {}
  HWY_ATTR Pairs(V h, V l) : high(h), low(l) {}
};

HWY_ATTR inline Pairs exact_sum(V a, V b) {
  const V sum = hn::Add(a, b), back = hn::Sub(sum, a);
  return {sum, hn::Add(hn::Sub(a, hn::Sub(sum, back)), hn::Sub(b, back))};
}

HWY_ATTR inline Pairs exact_product(V a, V b) {
  const V high = hn::Mul(a, b);
#if HWY_NATIVE_FMA
  return {high, hn::MulSub(a, b, high)};
#else  // Veltkamp's halves
  const V split = hn::Set(D(), 134217729.0);
  const V a_split = hn::Mul(a, split), a_high = hn::Sub(a_split, hn::Sub(a_split, a)),
          a_low = hn::Sub(a, a_high);
  const V b_split = hn::Mul(b, split), b_high = hn::Sub(b_split, hn::Sub(b_split, b)),
          b_low = hn::Sub(b, b_high);
  const V rest = hn::Sub(hn::Mul(a_high, b_high), high);
  const V middle = hn::Add(hn::Add(rest, hn::Mul(a_high, b_low)), hn::Mul(a_low, b_high));
  return {high, hn::Add(middle, hn::Mul(a_low, b_low))};
#endif
}

HWY_ATTR inline Pairs sum(Pairs a, Pairs b) {
  const Pairs s = exact_sum(a.high, b.high);
  return {s.high, hn::Add(s.low, hn::Add(a.low, b.low))};
}

HWY_ATTR inline Pairs negative(Pairs a) {
  return {hn::Neg(a.high), hn::Neg(a.low)};
}

HWY_ATTR inline Pairs difference(Pairs a, Pairs b) {
  return sum(a, negative(b));
}

// Of pairs whose low parts are within the last place of the high ones, as is what is returned: off by 2^-104
// of itself and of the low parts.
HWY_ATTR inline Pairs precise_sum(Pairs a, Pairs b) {
  const Pairs s = exact_sum(a.high, b.high), r = exact_sum(a.low, b.low);
  const Pairs first = exact_sum(s.high, hn::Add(s.low, r.high));
  return exact_sum(first.high, hn::Add(first.low, r.low));
}

HWY_ATTR inline Pairs product(Pairs a, V b) {
  const Pairs p = exact_product(a.high, b);
  return {p.high, hn::MulAdd(a.low, b, p.low)};
}

HWY_ATTR inline Pairs product(Pairs a, Pairs b) {
  const Pairs p = exact_product(a.high, b.high);
  return {p.high, hn::MulAdd(a.high, b.low, hn::MulAdd(a.low, b.high, p.low))};
}

template <class Other>
HWY_ATTR inline void cross(const Pairs (&a)[3], const Other (&b)[3], Pairs (&c)[3]) {
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    c[k] = difference(product(a[l], b[m]), product(a[m], b[l]));
  }
}

template <class Other>
HWY_ATTR inline Pairs dot(const Pairs (&a)[3], const Other (&b)[3]) {
  return sum(sum(product(a[0], b[0]), product(a[1], b[1])), product(a[2], b[2]));
}

// To the nearest double, but for 2^-50 of its last place.
HWY_ATTR inline V quotient(Pairs a, Pairs b) {
  a = exact_sum(a.high, a.low), b = exact_sum(b.high, b.low);
  const V about = hn::Div(a.high, b.high);
  const Pairs left = difference(a, product(b, about));
  return hn::Add(about, hn::Div(hn::Add(left.high, left.low), b.high));
}

// The lanes from `lane` on, as many as a vector has.
class Crossed {
 public:
  HWY_ATTR Crossed(const CrossedTriangles& rows, std::size_t lane) {
    for (int k = 0; k < 3; ++k) {
      const V first = load(rows.corner[0][k] + lane), origin = load(rows.origin[k] + lane);
      e_[k] = exact_sum(load(rows.corner[1][k] + lane), hn::Neg(first));
      f_[k] = exact_sum(load(rows.corner[2][k] + lane), hn::Neg(first));
      a_[k] = exact_sum(first, hn::Neg(origin));
      a_[k].low = hn::Sub(a_[k].low, load(rows.rest[k] + lane));
      a_size_[k] = hn::Add(hn::Abs(first), hn::Abs(origin));
      direction_[k] = load(rows.direction[k] + lane);
    }
    cross(e_, f_, normal_);
    facing_ = dot(normal_, direction_);
  }

  // t, and whether enough of it is left.
  HWY_ATTR V t(V* is_sure) const {
    const Pairs volume = dot(normal_, a_);
    V volume_size = hn::Zero(D()), facing_size = volume_size;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      const V size = hn::MulAdd(hn::Abs(e_[l].high), hn::Abs(f_[m].high),
                                hn::Mul(hn::Abs(e_[m].high), hn::Abs(f_[l].high)));
      volume_size = hn::MulAdd(size, a_size_[k], volume_size);
      facing_size = hn::MulAdd(size, hn::Abs(direction_[k]), facing_size);
    }
    const auto enough = [](Pairs value, V size) HWY_ATTR {  // NaN is not
      return hn::Ge(hn::Abs(hn::Add(value.high, value.low)), hn::Mul(hn::Set(D(), 0x1p-38), size));
    };
    const V t = quotient(volume, facing_);
    const auto is_told = hn::And(enough(facing_, facing_size), hn::Eq(t, t));
    *is_sure = hn::IfThenElseZero(hn::And(enough(volume, volume_size), is_told), hn::Set(D(), 1.0));
    return t;
  }

  // Seen from where t lies, which loses less than the origin where that is far off.
  // Source: Moller, Trumbore 1997.
  HWY_ATTR void weights(V t, double* u, double* v) const {
    Pairs near[3], across[3];
    for (int k = 0; k < 3; ++k) near[k] = precise_sum(a_[k], negative(exact_product(t, direction_[k])));
    cross(near, direction_, across);
    const V facing = hn::Add(facing_.high, facing_.low);
    const auto weight = [&](Pairs w) HWY_ATTR {
      return hn::Min(hn::Abs(hn::Div(hn::Add(w.high, w.low), facing)), hn::Set(D(), 1.0));
    };
    const auto has_area = hn::Ne(facing, hn::Zero(D()));
    const V second = weight(dot(across, f_)), left = hn::Sub(hn::Set(D(), 1.0), second),
            third = hn::Min(weight(dot(across, e_)), left), even = hn::Set(D(), 1.0 / 3);
    hn::StoreU(hn::IfThenElse(has_area, second, even), D(), u);
    hn::StoreU(hn::IfThenElse(has_area, third, even), D(), v);
  }

 private:
  static HWY_ATTR V load(const double* row) { return hn::LoadU(D(), row); }

  // Edges from the first corner, and the way to it from the line's origin.
  Pairs e_[3], f_[3], a_[3], normal_[3], facing_;
  V a_size_[3], direction_[3];
};

HWY_ATTR void TellHits(const CrossedTriangles& rows, ToldHits& told) {
  for (std::size_t lane = 0; lane < CrossedTriangles::kLanes; lane += hn::Lanes(D())) {
    const Crossed crossed(rows, lane);
    V is_sure;
    const V t = crossed.t(&is_sure);
    hn::StoreU(t, D(), told.t + lane);
    hn::StoreU(is_sure, D(), told.is_sure + lane);
    crossed.weights(t, told.u + lane, told.v + lane);
  }
}

}  // namespace kdray::query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kdray::query {

HWY_EXPORT(TellHits);

void tell_hits(const CrossedTriangles& crossed, ToldHits& told) {
  HWY_DYNAMIC_DISPATCH(TellHits)(crossed, told);
}

}  // namespace kdray::query
#endif
