#include "engine/query/double_walk.h"

#include "base/highway_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/query/double_walk.cpp"
// First, as it includes this file for each instruction set.
#include "hwy/foreach_target.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "base/local_space.h"
#include "engine/query/wide_boxes.h"
#include "hwy/highway.h"
#include "layout/tree.layout.h"
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

inline void fetch(const void* begin, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(static_cast<const char*>(begin) + i);
}

struct Scene {
  const flatten::WideForm& wide;
  const scene::DoubleGeometry& doubles;
  Decider& decider;
};

// A line in flight. kBlock: primitives to a block.
template <std::size_t kBlock>
class Walk {
 public:
  HWY_ATTR Walk(const Scene& scene, Entry* stack) : scene_(&scene), bottom_(stack), top_(stack) {}

  HWY_ATTR void start(const LineInFloats& line, std::size_t number) {
    line_ = &line;
    number_ = number;
    end_ = line.end;
    top_ = bottom_;
    rows_ = nullptr;
    undecided_ = 0;
    if (line.begin <= line.end) open(0);
  }

  // Whether there is another.
  HWY_ATTR bool step() {
    if (undecided_ != 0) return decide();
    if (rows_ != nullptr) {
      test();
      return true;
    }
    while (top_ != bottom_) {
      const Entry entry = *--top_;
      if (entry.enter > end_) continue;
      if (!(entry.child & KDRAY_WIDE_LEAF)) {
        open(entry.child);
      } else if (is_of_triangles(entry.child)) {
        rows_ = rows_of(entry.child);
        test();
      } else if (!decide_shapes(entry.child)) {
        return false;
      }
      return true;
    }
    return false;
  }

 private:
  // Pushes the children that the line meets, the nearest last. Slots without a child have nothing between
  // their bounds.
  HWY_ATTR void open(u32 index) {
    const layout::WideNode& node = scene_->wide.nodes[index];
    const hn::CappedTag<float, 8> d;
    float enters[8];
    u32 met = 0;
    for (std::size_t slot = 0; slot < 8; slot += hn::Lanes(d)) {
      auto enter = hn::Set(d, line_->begin), leave = hn::Set(d, end_);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto first = hn::LoadU(d, node.bounds[k][line_->upper_first[k]] + slot);
        const auto last = hn::LoadU(d, node.bounds[k][1 - line_->upper_first[k]] + slot);
        const auto inverse = hn::Set(d, line_->inverse[k]);
        enter = hn::Max(enter, hn::Mul(hn::Sub(first, hn::Set(d, line_->first[k])), inverse));
        leave = hn::Min(leave, hn::Mul(hn::Sub(last, hn::Set(d, line_->last[k])), inverse));
      }
      hn::StoreU(enter, d, enters + slot);
      met |= bits_of(d, hn::Le(enter, leave)) << slot;
    }
    if ((met & (met - 1)) == 0) {
      if (met == 0) return;
      const int slot = std::countr_zero(met);
      *top_++ = {enters[slot], node.child[slot]};
    } else {
      Entry* top = top_;
      for (u32 order = node.order[line_->octant], i = 0; i < 8; ++i, order >>= 3) {
        const u32 slot = order & 7;
        *top = {enters[slot], node.child[slot]};
        top += met >> slot & 1;
      }
      top_ = top;
    }
    const u32 next = top_[-1].child;
    if (!(next & KDRAY_WIDE_LEAF))
      fetch(&scene_->wide.nodes[next], sizeof(layout::WideNode));
    else if (is_of_triangles(next))
      fetch(rows_of(next), kRows * kBlock * sizeof(u32));
  }

  static bool is_of_triangles(u32 leaf) { return flatten::leaf_kind(leaf) == KDRAY_KIND_TRIANGLE; }

  // Whether the line goes on.
  bool decide_shapes(u32 leaf) {
    return !visit_leaf(scene_->wide, leaf, [&](auto kind, u32 index, const u32*) {
      end_ = scene_->decider.decide(number_, kind.kNumber << KDRAY_REF_KIND_SHIFT | index);
      return end_ < line_->begin;
    });
  }

  HWY_ATTR const u32* rows_of(u32 leaf) const {
    return scene_->wide.triangle_blocks.data() + (leaf & KDRAY_WIDE_FIRST_MASK) * kRows * kBlock;
  }

  // Looks at a block. Lanes without a triangle hold NaN, of which nothing is true, and the last one tells
  // whether there are more blocks.
  HWY_ATTR void test() {
    const hn::CappedTag<float, kBlock> d;
    undecided_ = 0;
    for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d))
      undecided_ |= may_cross(d, rows_ + lane) << lane;
    indices_ = rows_ + (kRows - 1) * kBlock;
    const bool is_last = (indices_[kBlock - 1] & KDRAY_WIDE_LAST) != 0;
    has_fetched_ = false;
    rows_ = is_last ? nullptr : rows_ + kRows * kBlock;
    for_each_undecided([&](u32 triangle) {
      __builtin_prefetch(&scene_->doubles.corners[triangle]);
      return true;
    });
  }

  // In two steps: where corners are is told by what had to be fetched as well.
  HWY_ATTR bool decide() {
    if (!has_fetched_) {
      has_fetched_ = true;
      return for_each_undecided([&](u32 triangle) {
        for (const u32 vertex : scene_->doubles.corners[triangle])
          fetch(&scene_->doubles.vertices[vertex], sizeof(dvec3));
        return true;
      });
    }
    const bool goes_on = for_each_undecided([&](u32 triangle) {
      static_assert(KDRAY_KIND_TRIANGLE == 0);  // its number is the reference
      end_ = scene_->decider.decide(number_, triangle);
      return end_ >= line_->begin;
    });
    undecided_ = 0;
    return goes_on;
  }

  template <class Visit>
  HWY_ATTR bool for_each_undecided(const Visit& visit) const {
    for (u32 left = undecided_; left != 0; left &= left - 1)
      if (!visit(indices_[std::countr_zero(left)] & ~KDRAY_WIDE_LAST)) return false;
    return true;
  }

  template <class D>
  HWY_ATTR static hn::Vec<D> values_at(D d, const u32* words) {
    return hn::BitCast(d, hn::LoadU(hn::RebindToUnsigned<D>(), words));
  }

  template <class D>
  HWY_ATTR u32 may_cross(D d, const u32* rows) const {
    hn::Vec<D> x[3], y[3], z[3], most = hn::Zero(d);
    const auto shear_x = hn::Set(d, line_->shear[0]), shear_y = hn::Set(d, line_->shear[1]);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = [&](std::size_t k) HWY_ATTR {
        const auto axis = static_cast<std::size_t>(line_->axis[k]);
        return hn::Sub(values_at(d, rows + (3 * i + axis) * kBlock), hn::Set(d, line_->origin[axis]));
      };
      z[i] = at(2);
      x[i] = hn::Sub(at(0), hn::Mul(shear_x, z[i]));
      y[i] = hn::Sub(at(1), hn::Mul(shear_y, z[i]));
      most = hn::Max(most, hn::Max(hn::Abs(x[i]), hn::Abs(y[i])));
    }
    const auto edge = [&](std::size_t p, std::size_t q)
                          HWY_ATTR { return hn::Sub(hn::Mul(x[q], y[p]), hn::Mul(y[q], x[p])); };
    const float e = line_->displaced;
    const auto slope = hn::Add(hn::Set(d, 4 * e), hn::Mul(hn::Set(d, 0x1p-21f), most));
    const auto bound = hn::Mul(hn::Set(d, 1.01f), hn::Add(hn::Mul(most, slope), hn::Set(d, 2 * e * e)));
    const auto a = edge(1, 2), b = edge(2, 0), c = edge(0, 1);
    const auto least = hn::Min(a, hn::Min(b, c)), greatest = hn::Max(a, hn::Max(b, c));
    return bits_of(d, hn::Or(hn::Ge(least, hn::Neg(bound)), hn::Le(greatest, bound)));
  }

  static constexpr std::size_t kRows = KDRAY_TRIANGLE_ROWS;

  const Scene* scene_;
  const LineInFloats* line_ = nullptr;
  std::size_t number_ = 0;
  Entry *bottom_, *top_;
  float end_ = 0;
  const u32* rows_ = nullptr;     // of the block that is to be looked at next; null: the stack has it
  const u32* indices_ = nullptr;  // of the block that was looked at last
  u32 undecided_ = 0;             // lanes of it
  bool has_fetched_ = false;
};

template <std::size_t kBlock>
HWY_ATTR void walk_all(const Scene& scene, std::span<const LineInFloats> lines) {
  constexpr std::size_t kInFlight = 16;  // counts take a twentieth less than with 8, closest hits the same
  thread_local std::vector<Entry> stacks;
  const std::size_t capacity = static_cast<std::size_t>(scene.wide.stack_size) + 8;
  if (stacks.size() < kInFlight * capacity) stacks.resize(kInFlight * capacity);
  std::vector<Walk<kBlock>> walks;
  walks.reserve(kInFlight);
  std::size_t next = 0;
  for (; next < std::min(lines.size(), kInFlight); ++next) {
    walks.emplace_back(scene, stacks.data() + next * capacity);
    walks.back().start(lines[next], next);
  }
  while (!walks.empty())
    for (std::size_t i = 0; i < walks.size(); ++i) {
      if (walks[i].step()) continue;
      if (next < lines.size()) {
        walks[i].start(lines[next], next);
        ++next;
      } else {
        walks[i] = walks.back();
        walks.pop_back();
      }
    }
}

HWY_ATTR void WalkPrimitives(const flatten::WideForm& wide, const scene::DoubleGeometry& doubles,
                             std::span<const LineInFloats> lines, Decider& decider) {
  const Scene scene{wide, doubles, decider};
  wide.block == 8 ? walk_all<8>(scene, lines) : walk_all<4>(scene, lines);
}

}  // namespace kdray::query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kdray::query {

HWY_EXPORT(WalkPrimitives);

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

void walk_primitives(const flatten::WideForm& wide, const scene::DoubleGeometry& doubles,
                     std::span<const LineInFloats> lines, Decider& decider) {
  if (wide.nodes.size() == 0) return;
  HWY_DYNAMIC_DISPATCH(WalkPrimitives)(wide, doubles, lines, decider);
}

}  // namespace kdray::query
#endif
