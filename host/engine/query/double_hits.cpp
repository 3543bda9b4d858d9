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

// Some 2^-104 of a sum's or product's terms exact. Source: Dekker 1971; Joldes, Muller, Popescu 2017.
struct Pairs {
  V high, low;
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

HWY_ATTR inline Pairs with_low(V high, V low) {  // |low| is no more than |high|, or high is 0
  const V sum = hn::Add(high, low);
  return {sum, hn::Sub(low, hn::Sub(sum, high))};
}

HWY_ATTR inline Pairs sum(Pairs a, Pairs b) {
  const Pairs s = exact_sum(a.high, b.high), r = exact_sum(a.low, b.low);
  const Pairs first = with_low(s.high, hn::Add(s.low, r.high));
  return with_low(first.high, hn::Add(first.low, r.low));
}

HWY_ATTR inline Pairs difference(Pairs a, Pairs b) {
  return sum(a, {hn::Neg(b.high), hn::Neg(b.low)});
}

HWY_ATTR inline Pairs product(Pairs a, V b) {
  const Pairs p = exact_product(a.high, b);
  return with_low(p.high, hn::MulAdd(a.low, b, p.low));
}

HWY_ATTR inline Pairs product(Pairs a, Pairs b) {
  const Pairs p = exact_product(a.high, b.high);
  return with_low(p.high, hn::MulAdd(a.high, b.low, hn::MulAdd(a.low, b.high, p.low)));
}

// To the nearest double, but for 2^-50 of its last place.
HWY_ATTR inline V quotient(Pairs a, Pairs b) {
  const V about = hn::Div(a.high, b.high);
  const Pairs left = difference(a, product(b, about));
  return hn::Add(about, hn::Div(hn::Add(left.high, left.low), b.high));
}

// The lanes from `lane` on, as many as a vector has.
class Crossed {
 public:
  HWY_ATTR Crossed(const CrossedTriangles& rows, std::size_t lane) : rows_(rows), lane_(lane) {}

  // t, and whether enough of it is left.
  HWY_ATTR V t(V* is_sure) const {
    Pairs e[3], f[3], a[3];
    V a_size[3];
    for (int k = 0; k < 3; ++k) {
      const V first = at(rows_.corner[0][k]), origin = at(rows_.origin[k]);
      e[k] = exact_sum(at(rows_.corner[1][k]), hn::Neg(first));
      f[k] = exact_sum(at(rows_.corner[2][k]), hn::Neg(first));
      a[k] = from_origin(0, k);
      a_size[k] = hn::Add(hn::Abs(first), hn::Abs(origin));
    }
    const V zero = hn::Zero(D());
    Pairs volume{zero, zero}, facing{zero, zero};
    V volume_size = zero, facing_size = zero;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      const Pairs n = difference(product(e[l], f[m]), product(e[m], f[l]));
      const V size = hn::Add(hn::Abs(hn::Mul(e[l].high, f[m].high)), hn::Abs(hn::Mul(e[m].high, f[l].high)));
      const V direction = at(rows_.direction[k]);
      volume = sum(volume, product(n, a[k]));
      facing = sum(facing, product(n, direction));
      volume_size = hn::MulAdd(size, a_size[k], volume_size);
      facing_size = hn::MulAdd(size, hn::Abs(direction), facing_size);
    }
    const auto enough = [](Pairs value, V size) HWY_ATTR {
      return hn::Ge(hn::Abs(value.high), hn::Mul(hn::Set(D(), 0x1p-38), size));
    };
    *is_sure = hn::IfThenElseZero(hn::And(enough(volume, volume_size), enough(facing, facing_size)),
                                  hn::Set(D(), 1.0));
    return quotient(volume, facing);
  }

  // In the plane across the direction's largest axis, z.
  HWY_ATTR void weights(double* u, double* v) const {
    const V size_x = hn::Abs(at(rows_.direction[0])), size_y = hn::Abs(at(rows_.direction[1])),
            size_z = hn::Abs(at(rows_.direction[2]));
    const auto is_z = hn::And(hn::Ge(size_z, size_x), hn::Ge(size_z, size_y)), is_y = hn::Ge(size_y, size_x);
    const auto of_axis = [&](int k, auto value) HWY_ATTR {  // of the k-th axis after z
      return hn::IfThenElse(is_z, value(k), hn::IfThenElse(is_y, value((k + 2) % 3), value((k + 1) % 3)));
    };
    const auto direction = [&](int k) HWY_ATTR {
      return of_axis(k, [&](int l) HWY_ATTR { return at(rows_.direction[l]); });
    };
    const auto place = [&](int corner, int k) HWY_ATTR {
      return Pairs{of_axis(k, [&](int l) HWY_ATTR { return from_origin(corner, l).high; }),
                   of_axis(k, [&](int l) HWY_ATTR { return from_origin(corner, l).low; })};
    };
    const V dx = direction(0), dy = direction(1), dz = direction(2);
    Pairs x[3], y[3];
    for (int i = 0; i < 3; ++i) {
      const Pairs z = place(i, 2);
      x[i] = difference(product(place(i, 0), dz), product(z, dx));
      y[i] = difference(product(place(i, 1), dz), product(z, dy));
    }
    const auto weight = [&](int p, int q) HWY_ATTR {
      const Pairs w = difference(product(x[q], y[p]), product(y[q], x[p]));
      return hn::Abs(hn::Add(w.high, w.low));
    };
    const V wa = weight(1, 2), wb = weight(2, 0), wc = weight(0, 1), all = hn::Add(hn::Add(wa, wb), wc);
    const auto has_area = hn::Gt(all, hn::Zero(D()));
    const V third = hn::Set(D(), 1.0 / 3);
    hn::StoreU(hn::IfThenElse(has_area, hn::Div(wb, all), third), D(), u + lane_);
    hn::StoreU(hn::IfThenElse(has_area, hn::Div(wc, all), third), D(), v + lane_);
  }

 private:
  HWY_ATTR V at(const double* row) const { return hn::LoadU(D(), row + lane_); }
  HWY_ATTR Pairs from_origin(int corner, int k) const {
    const Pairs d = exact_sum(at(rows_.corner[corner][k]), hn::Neg(at(rows_.origin[k])));
    return with_low(d.high, hn::Sub(d.low, at(rows_.rest[k])));
  }

  const CrossedTriangles& rows_;
  std::size_t lane_;
};

HWY_ATTR void TellHits(const CrossedTriangles& rows, ToldHits& told) {
  for (std::size_t lane = 0; lane < CrossedTriangles::kLanes; lane += hn::Lanes(D())) {
    const Crossed crossed(rows, lane);
    V is_sure;
    hn::StoreU(crossed.t(&is_sure), D(), told.t + lane);
    hn::StoreU(is_sure, D(), told.is_sure + lane);
    crossed.weights(told.u, told.v);
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
