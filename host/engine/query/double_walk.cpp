#include "engine/query/double_walk.h"

// The fallback for any machine is Highway's emulation of 128 bits, which it avoids with g++ before 12.3 for a
// fault in products of 16-bit integers (GCC bug 106322); there are none here.
#define HWY_BROKEN_EMU128 0
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/query/double_walk.cpp"
// First, as it includes this file for each instruction set.
#include "hwy/foreach_target.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "base/local_space.h"
#include "hwy/highway.h"
#include "layout/wide.layout.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::query::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using layout::u32;

struct Entry {
  float enter;
  u32 child;
};

template <class D>
HWY_ATTR u32 bits_of(D d, hn::Mask<D> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0];
}

// kBlock: primitives to a block.
template <std::size_t kBlock>
class Walk {
 public:
  HWY_ATTR Walk(const flatten::WideForm& wide, const LineInFloats& line, FoundTriangle found, void* context)
      : wide_(wide), line_(line), found_(found), context_(context), end_(line.end) {}

  HWY_ATTR void run() {
    thread_local std::vector<Entry> stack;
    const std::size_t capacity = static_cast<std::size_t>(wide_.stack_size) + 8;
    if (stack.size() < capacity) stack.resize(capacity);
    const Entry* const bottom = stack.data();
    Entry* top = open(0, stack.data());
    while (top != bottom) {
      const Entry entry = *--top;
      if (entry.enter > end_) continue;
      if (!(entry.child & KDRAY_WIDE_LEAF)) {
        top = open(entry.child, top);
      } else if (!test(entry.child)) {
        return;
      }
    }
  }

 private:
  // Pushes the children that the line meets, the nearest last. Slots without a child have nothing between
  // their bounds.
  HWY_ATTR Entry* open(u32 index, Entry* top) const {
    const layout::WideNode& node = wide_.nodes[index];
    const hn::CappedTag<float, 8> d;
    float enters[8];
    u32 met = 0;
    for (std::size_t slot = 0; slot < 8; slot += hn::Lanes(d)) {
      auto enter = hn::Set(d, line_.begin), leave = hn::Set(d, end_);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto first = hn::LoadU(d, node.bounds[k][line_.upper_first[k]] + slot);
        const auto last = hn::LoadU(d, node.bounds[k][1 - line_.upper_first[k]] + slot);
        const auto inverse = hn::Set(d, line_.inverse[k]);
        enter = hn::Max(enter, hn::Mul(hn::Sub(first, hn::Set(d, line_.first[k])), inverse));
        leave = hn::Min(leave, hn::Mul(hn::Sub(last, hn::Set(d, line_.last[k])), inverse));
      }
      hn::StoreU(enter, d, enters + slot);
      met |= bits_of(d, hn::Le(enter, leave)) << slot;
    }
    if ((met & (met - 1)) == 0) {
      if (met == 0) return top;
      const int slot = std::countr_zero(met);
      *top = {enters[slot], node.child[slot]};
      return top + 1;
    }
    for (u32 order = node.order[line_.octant], i = 0; i < 8; ++i, order >>= 3) {
      const u32 slot = order & 7;
      *top = {enters[slot], node.child[slot]};
      top += met >> slot & 1;
    }
    return top;
  }

  HWY_ATTR bool test(u32 leaf) {
    constexpr std::size_t kRows = KDRAY_TRIANGLE_ROWS;
    const hn::CappedTag<float, kBlock> d;
    const u32* rows = wide_.triangle_blocks.data() + (leaf & KDRAY_WIDE_FIRST_MASK) * kRows * kBlock;
    for (;; rows += kRows * kBlock)
      for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
        const u32* const index = rows + (kRows - 1) * kBlock + lane;
        const hn::RebindToUnsigned<decltype(d)> du;
        const u32 ends = bits_of(du, hn::TestBit(hn::LoadU(du, index), hn::Set(du, KDRAY_WIDE_LAST)));
        const u32 there = (ends ^ (ends - 1)) & ((u32{1} << hn::Lanes(d)) - 1);
        u32 may = there & ~surely_missed(d, rows + lane);
        for (; may != 0; may &= may - 1) {
          end_ = found_(context_, index[std::countr_zero(may)] & ~KDRAY_WIDE_LAST);
          if (end_ < line_.begin) return false;
        }
        if (ends != 0) return true;
      }
  }

  template <class D>
  HWY_ATTR static hn::Vec<D> values_at(D d, const u32* words) {
    return hn::BitCast(d, hn::LoadU(hn::RebindToUnsigned<D>(), words));
  }

  template <class D>
  HWY_ATTR u32 surely_missed(D d, const u32* rows) const {
    hn::Vec<D> x[3], y[3], z[3], most = hn::Zero(d);
    const auto shear_x = hn::Set(d, line_.shear[0]), shear_y = hn::Set(d, line_.shear[1]);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = [&](std::size_t k) HWY_ATTR {
        const auto axis = static_cast<std::size_t>(line_.axis[k]);
        return hn::Sub(values_at(d, rows + (3 * i + axis) * kBlock), hn::Set(d, line_.origin[axis]));
      };
      z[i] = at(2);
      x[i] = hn::Sub(at(0), hn::Mul(shear_x, z[i]));
      y[i] = hn::Sub(at(1), hn::Mul(shear_y, z[i]));
      most = hn::Max(most, hn::Max(hn::Abs(x[i]), hn::Abs(y[i])));
    }
    const auto edge = [&](std::size_t p, std::size_t q)
                          HWY_ATTR { return hn::Sub(hn::Mul(x[q], y[p]), hn::Mul(y[q], x[p])); };
    const float e = line_.displaced;
    const auto slope = hn::Add(hn::Set(d, 4 * e), hn::Mul(hn::Set(d, 0x1p-21f), most));
    const auto bound = hn::Mul(hn::Set(d, 1.01f), hn::Add(hn::Mul(most, slope), hn::Set(d, 2 * e * e)));
    const auto a = edge(1, 2), b = edge(2, 0), c = edge(0, 1);
    const auto least = hn::Min(a, hn::Min(b, c)), greatest = hn::Max(a, hn::Max(b, c));
    return bits_of(d, hn::And(hn::Lt(least, hn::Neg(bound)), hn::Gt(greatest, bound)));
  }

  const flatten::WideForm& wide_;
  const LineInFloats& line_;
  const FoundTriangle found_;
  void* const context_;
  float end_;
};

HWY_ATTR void WalkTriangles(const flatten::WideForm& wide, const LineInFloats& line, FoundTriangle found,
                            void* context) {
  if (wide.block == 8)
    Walk<8>(wide, line, found, context).run();
  else
    Walk<4>(wide, line, found, context).run();
}

}  // namespace kdray::query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kdray::query {

HWY_EXPORT(WalkTriangles);

LineInFloats::LineInFloats(const dvec3& from, const dvec3& direction, float margin, double reach)
    : begin(0), end(0), octant(0) {
  constexpr double kMost = 0x1p100;
  int z = 0;
  for (int k = 0; k < 3; ++k) {
    origin[k] = static_cast<float>(from[k]);
    inverse[k] = static_cast<float>(std::clamp(1 / direction[k], -kMost, kMost));
    upper_first[k] = inverse[k] < 0;
    first[k] = origin[k] + (upper_first[k] ? -margin : margin);
    last[k] = origin[k] - (upper_first[k] ? -margin : margin);
    octant |= (direction[k] < 0 ? 1u : 0u) << k;
    if (std::abs(direction[k]) > std::abs(direction[z])) z = k;
  }
  axis[0] = (z + 1) % 3, axis[1] = (z + 2) % 3, axis[2] = z;
  for (int i = 0; i < 2; ++i) shear[i] = static_cast<float>(direction[axis[i]] / direction[z]);
  displaced = static_cast<float>(16 * 0x1p-24 *
                                 (2 * reach + largest_component(dvec3(origin[0], origin[1], origin[2]))));
}

void walk_triangles(const flatten::WideForm& wide, const LineInFloats& line, FoundTriangle found,
                    void* context) {
  if (wide.nodes.size() == 0 || !(line.begin <= line.end)) return;
  HWY_DYNAMIC_DISPATCH(WalkTriangles)(wide, line, found, context);
}

}  // namespace kdray::query
#endif
