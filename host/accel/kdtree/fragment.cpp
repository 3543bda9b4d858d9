#include "accel/kdtree/fragment.h"

#include <algorithm>

#include "accel/kdtree/binned/simd.h"

namespace kdray::kdtree {

void Fragment::clear() {
  nodes.clear();
  refs.clear();
  contents.clear();
  max_depth = 0;
}

std::span<Ref> add_leaf(std::size_t n, const Bounds& contents, int depth, Fragment& out) {
  const std::size_t first = out.refs.size();
  out.refs.resize(first + n);
  out.contents.push_back(box_from(contents));
  out.nodes.push_back({Node::kLeaf, 0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(n)});
  out.max_depth = std::max(out.max_depth, depth);
  return std::span(out.refs).subspan(first);
}

void write_sorted(std::span<const BoundedRef> refs, std::span<Ref> out) {
  std::transform(refs.begin(), refs.end(), out.begin(), [](const BoundedRef& r) { return r.ref; });
  std::sort(out.begin(), out.end());
}

Box append_cell(std::span<BoundedRef> refs, const Bounds& contents, int depth, const BuildConfig& config,
                Fragment& out) {
  if (config.groups) {
    binned::append_groups(refs, contents, depth, config, out);
  } else {
    write_sorted(refs, add_leaf(refs.size(), contents, depth, out));
  }
  return box_from(contents);
}

}  // namespace kdray::kdtree
