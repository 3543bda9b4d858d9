#include "kdtree/fragment.h"

#include <algorithm>

namespace kdray::kdtree {

void Fragment::clear() {
  nodes.clear();
  refs.clear();
  contents.clear();
  max_depth = 0;
}

Box append_leaf(std::span<const BoundedRef> refs, const Bounds& contents, int depth, Fragment& out) {
  const std::size_t first = out.refs.size();
  out.refs.resize(first + refs.size());
  const auto own = std::span(out.refs).subspan(first);
  std::transform(refs.begin(), refs.end(), own.begin(), [](const BoundedRef& r) { return r.ref; });
  std::sort(own.begin(), own.end());
  out.contents.push_back(box_from(contents));
  out.nodes.push_back(
      {Node::kLeaf, 0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(refs.size())});
  out.max_depth = std::max(out.max_depth, depth);
  return out.contents.back();
}

}  // namespace kdray::kdtree
