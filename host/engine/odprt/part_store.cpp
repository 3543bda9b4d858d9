#include "engine/odprt/part_store.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "layout/compressed.layout.h"

namespace kdray::odprt {

namespace {

using wavefront::SceneBuffers;

// For each array the size that it has in the part that has most of it.
SceneBuffers::Sizes largest_sizes(const Division& division) {
  SceneBuffers::Sizes most{};
  for (const Part& part : division.parts) {
    const SceneBuffers::Sizes sizes = SceneBuffers::sizes_of(part.flat, part.wide);
    for (std::size_t i = 0; i < sizes.size(); ++i) most[i] = std::max(most[i], sizes[i]);
  }
  return most;
}

}  // namespace

std::size_t buffer_bytes(const Division& division, bool compressed) {
  SceneBuffers::Sizes sizes = largest_sizes(division);
  for (const std::size_t no_geometry : {SceneBuffers::Slot::materials, SceneBuffers::Slot::lights})
    sizes[no_geometry] = 0;
  const std::size_t n_nodes = sizes[SceneBuffers::Slot::wide_nodes] / sizeof(layout::WideNode);
  return std::accumulate(sizes.begin(), sizes.end(),
                         compressed ? n_nodes * sizeof(layout::CompressedNode) : std::size_t{0});
}

SceneBuffers PartStore::scene_of(const Part& part) {
  if (!streamed_) return {context_, part.flat, part.wide};
  if (!buffers_) buffers_.emplace(context_, largest_sizes(division_));
  buffers_->copy(queue_, part.flat, part.wide);
  return *buffers_;
}

const LoadedPart& PartStore::get(std::uint32_t number) {
  if (loaded_ && loaded_->number == number) return *loaded_;
  const Part& part = division_.parts[number];
  std::vector<layout::PartCell> cells;
  for (const std::uint32_t i : division_.subtrees_of(number)) {
    const Box& box = cut_.subtrees[i].bounds;
    cells.push_back({{box.lo.x, box.lo.y, box.lo.z}, number, {box.hi.x, box.hi.y, box.hi.z}, 0});
  }
  loaded_.emplace(
      LoadedPart{number, part.n_shared, division_.replicates(), scene_of(part),
                 context_.buffer(CL_MEM_READ_ONLY, cells.size() * sizeof cells[0], "the subtrees"),
                 static_cast<std::uint32_t>(cells.size())});
  if (!cells.empty())
    queue_.enqueueWriteBuffer(loaded_->subtrees, CL_TRUE, 0, cells.size() * sizeof cells[0], cells.data());
  ++n_loads_;
  return *loaded_;
}

std::size_t PartStore::bytes() const {
  if (buffers_) return buffer_bytes(division_, compressed_);
  if (!loaded_) return 0;
  const Part& part = division_.parts[loaded_->number];
  return part.geometry_bytes() + (compressed_ ? part.wide.nodes.size() * sizeof(layout::CompressedNode) : 0);
}

}  // namespace kdray::odprt
