#include "kdtree/fragment.h"

#include <algorithm>

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

Box append_leaf(std::span<const BoundedRef> refs, const Bounds& contents, int depth, Fragment& out) {
  write_sorted(refs, add_leaf(refs.size(), contents, depth, out));
  return out.contents.back();
}

}  // namespace kdray::kdtree
