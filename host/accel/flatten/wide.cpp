#include "accel/flatten/wide.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "accel/flatten/collapse.h"
#include "accel/flatten/leaf_block.h"
#include "base/error.h"
#include "scene/primitives/shapes.h"

namespace kdray::flatten {

namespace {

using primitives::rows_of;

// How many references ahead primitives are prefetched: those of the next leaves follow this one's.
constexpr std::uint32_t kAhead = 16;

// (Inlined: g++ takes a function that does nothing else for one without effect, and leaves out calls of it.)
template <class Primitive>
[[gnu::always_inline]] inline void prefetch(const kdtree::Tree& tree, std::size_t ref,
                                            const Array<Primitive>& primitives) {
  if (ref >= tree.refs.size()) return;
  const std::size_t index = kdtree::ref_index(tree.refs[ref]);
  if (index < primitives.size()) __builtin_prefetch(primitives.data() + index);  // it may be of another kind
}

using FourLanes = float __attribute__((vector_size(16)));

// Writes the rows of corners of `block` triangles, as vectors: the rows are read as vectors right after, for
// the limits, which would have to wait for stores of single lanes.
void write_corners(const std::array<const layout::Triangle*, 8>& triangles, std::uint32_t block,
                   layout::u32* words) {
  for (std::uint32_t lane = 0; lane < block; lane += 4) {
    const float* const a = triangles[lane]->v[0];
    const float* const b = triangles[lane + 1]->v[0];
    const float* const c = triangles[lane + 2]->v[0];
    const float* const d = triangles[lane + 3]->v[0];
    for (std::uint32_t row = 0; row < 9; ++row) {
      const FourLanes four{a[row], b[row], c[row], d[row]};
      std::memcpy(words + row * block + lane, &four, sizeof four);
    }
  }
}

constexpr layout::Triangle no_triangle() {
  layout::Triangle t{};
  for (auto& corner : t.v)
    for (float& x : corner) x = std::numeric_limits<float>::quiet_NaN();
  return t;
}

void write_blocks(primitives::TriangleKind, const kdtree::Tree& tree, const kdtree::RefRun& run,
                  const Array<layout::Triangle>& triangles, std::uint32_t block, layout::u32* words) {
  static constexpr layout::Triangle kNone = no_triangle();
  for (std::uint32_t done = 0; done < run.n; done += block, words += KDRAY_TRIANGLE_ROWS * block) {
    const std::uint32_t n = std::min(block, run.n - done);
    layout::u32* const indices = words + KDRAY_ROW_TRIANGLE_INDEX * block;
    std::array<const layout::Triangle*, 8> here;
    here.fill(&kNone);
    for (std::uint32_t lane = 0; lane < n; ++lane) {
      const std::uint32_t ref = run.first + done + lane;
      prefetch(tree, ref + kAhead, triangles);
      const std::uint32_t index = kdtree::ref_index(tree.refs[ref]);
      here[lane] = &triangles[index];
      indices[lane] = index | (done + lane + 1 == run.n ? KDRAY_WIDE_LAST : 0);
    }
    std::fill(indices + n, indices + block, KDRAY_WIDE_LAST);
    write_corners(here, block, words);
    finish_triangles(triangles, n, block, words);
  }
}

// Writes a leaf's blocks of one kind of shapes, from `words` on.
template <class Kind>
void write_blocks(Kind, const kdtree::Tree& tree, const kdtree::RefRun& run,
                  const Array<typename Kind::Layout>& primitives, std::uint32_t block, layout::u32* words) {
  constexpr std::size_t kRows = Kind::kRows - 1;  // but for the index
  for (std::uint32_t done = 0; done < run.n; done += block, words += (kRows + 1) * block) {
    const std::uint32_t n = std::min(block, run.n - done);
    for (std::uint32_t lane = 0; lane < n; ++lane) {
      const std::uint32_t ref = run.first + done + lane;
      prefetch(tree, ref + kAhead, primitives);
      const std::uint32_t index = kdtree::ref_index(tree.refs[ref]);
      const auto rows = rows_of(primitives[index]);
      for (std::size_t r = 0; r < rows.size(); ++r) words[r * block + lane] = bits(rows[r]);
      words[kRows * block + lane] = index | (done + lane + 1 == run.n ? KDRAY_WIDE_LAST : 0);
    }
    if (n < block) clear_lanes(n, block, kRows, words);
  }
}

// Where a part's nodes and blocks begin in the form.
struct Places {
  std::size_t first_node = 0;
  std::array<std::size_t, primitives::kKinds> first_block{};

  void skip(const CollapsedPart& part) {
    first_node += part.nodes.size();
    for (std::size_t kind = 0; kind < primitives::kKinds; ++kind) first_block[kind] += part.n_blocks[kind];
  }
};

// Writes parts where they go: nodes with their bounds, and the blocks of their leaves.
class Writer {
 public:
  Writer(const kdtree::Tree& tree, const FlatScene& primitives, WideForm& form)
      : tree_(tree), primitives_(primitives), block_(static_cast<std::uint32_t>(form.block)), form_(form) {}

  // `cuts`: the places of the parts cut off, from the first on.
  void write(const CollapsedPart& part, const Places& places, const Places* cuts) const {
    for (std::size_t i = 0; i < part.nodes.size(); ++i)
      write_node(part.nodes[i], places, cuts, places.first_node + i);
  }

 private:
  void write_node(const CollapsedNode& node, const Places& places, const Places* cuts,
                  std::size_t index) const {
    layout::WideNode& out = form_.nodes[index];
    for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
      set_bounds(out, slot, slot < node.n ? tree_.contents[node.item[slot]] : Box());
      out.order[slot] = node.order[slot];
      out.child[slot] = slot < node.n ? child_word(node.child[slot], node.item[slot], places, cuts) : 0;
    }
  }

  layout::u32 child_word(layout::u32 child, std::uint32_t item, const Places& places,
                         const Places* cuts) const {
    if (child & KDRAY_WIDE_LEAF) {
      const std::uint32_t kind = leaf_kind(child);
      const std::size_t first = (child & KDRAY_WIDE_FIRST_MASK) + places.first_block[kind];
      write_leaf(item, kind, first);
      return (child & ~KDRAY_WIDE_FIRST_MASK) | static_cast<layout::u32>(first);
    }
    if (child & CollapsedPart::kCut)
      return static_cast<layout::u32>(cuts[child & ~CollapsedPart::kCut].first_node);
    return child + static_cast<layout::u32>(places.first_node);
  }

  void write_leaf(std::uint32_t leaf, std::uint32_t kind_number, std::size_t first) const {
    const kdtree::RefRun run = leaf_run(tree_, leaf, kind_number);
    primitives::with_kind(kind_number, [&](auto kind) {
      using Kind = decltype(kind);
      write_blocks(kind, tree_, run, Kind::of(primitives_), block_,
                   Kind::blocks_of(form_).data() + first * Kind::kRows * block_);
    });
  }

  const kdtree::Tree& tree_;
  const FlatScene& primitives_;
  const std::uint32_t block_;
  WideForm& form_;
};

// The tree's top, and the parts below it that threads collapse apart.
struct Parts {
  CollapsedPart top;
  std::vector<CollapsedPart> below;
  int stack_size = 0;
};

std::uint32_t only_kind(const FlatScene& scene) {
  std::uint32_t n = 0, only = kAnyKind;
  primitives::for_each_kind([&](auto kind) {
    if (decltype(kind)::of(scene).empty()) return;
    ++n;
    only = decltype(kind)::kNumber;
  });
  return n == 1 ? only : kAnyKind;
}

Parts collapse_in_parts(const kdtree::Tree& tree, std::uint32_t block, std::uint32_t kind) {
  const auto n = static_cast<std::uint32_t>(tree.nodes.size());
  // Cuts into enough parts for any number of threads, none so small that it isn't worth a task.
  const std::uint32_t cut_at = std::max(n / 256, 512u);
  const Openings openings(tree, kind);
  Parts parts{collapse(tree, openings, {0, n}, block, kind, cut_at), {}, 0};
  parts.below.resize(parts.top.cuts.size());
  std::vector<StackNeeds> needs(parts.below.size());
  tbb::parallel_for(std::size_t{0}, parts.below.size(), [&](std::size_t i) {
    parts.below[i] = collapse(tree, openings, parts.top.cuts[i], block, kind, 0);
    needs[i] = stack_needs(parts.below[i], {});
  });
  const StackNeeds all = stack_needs(parts.top, needs);
  parts.stack_size = *std::max_element(all.begin(), all.end());
  return parts;
}

void check_sizes(const Places& all) {
  if (all.first_node > KDRAY_WIDE_NODE_MAX)
    throw Error(ErrorCode::input, "the kd-tree has over 2^29 wide nodes");
  if (*std::max_element(all.first_block.begin(), all.first_block.end()) > KDRAY_WIDE_FIRST_MASK)
    throw Error(ErrorCode::input, "the kd-tree has over 2^27 leaf blocks of one kind");
}

}  // namespace

std::size_t WideForm::bytes() const {
  std::size_t sum = 0;
  for_each_wide_array(*this, [&](const auto& array) { sum += array.bytes(); });
  return sum;
}

WideForm make_wide(const kdtree::Tree& tree, const FlatScene& primitives, int block) {
  WideForm form;
  form.block = block;
  const auto width = static_cast<std::uint32_t>(block);
  const Parts parts = collapse_in_parts(tree, width, only_kind(primitives));
  form.stack_size = parts.stack_size;
  std::vector<Places> places(parts.below.size());
  Places all;
  all.skip(parts.top);
  for (std::size_t i = 0; i < parts.below.size(); ++i) {
    places[i] = all;
    all.skip(parts.below[i]);
  }
  check_sizes(all);
  form.nodes = Array<layout::WideNode>(all.first_node);
  primitives::for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    Kind::blocks_of(form) = Array<layout::u32>(all.first_block[Kind::kNumber] * Kind::kRows * width);
  });
  const Writer writer(tree, primitives, form);
  writer.write(parts.top, Places(), places.data());
  tbb::parallel_for(std::size_t{0}, parts.below.size(),
                    [&](std::size_t i) { writer.write(parts.below[i], places[i], nullptr); });
  return form;
}

Lanes count_lanes(const kdtree::Tree& tree) {
  Lanes lanes;
  for (const kdtree::Node& node : tree.nodes)
    if (node.is_leaf()) {
      lanes.of4 += (node.right + 3) / 4 * 4;
      lanes.of8 += (node.right + 7) / 8 * 8;
    }
  return lanes;
}

int choose_block(const Lanes& lanes) {
  return 2 * lanes.of8 <= 3 * lanes.of4 ? 8 : 4;
}

int choose_block(const kdtree::Tree& tree) {
  return choose_block(count_lanes(tree));
}

}  // namespace kdray::flatten
