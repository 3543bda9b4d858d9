#include "odprt/part_store.h"

#include <algorithm>

namespace kdray::odprt {

std::unique_ptr<LoadedPart> PartStore::load(std::uint32_t number) {
  const Part& part = division_.parts[number];
  std::vector<layout::PartCell> cells;
  for (const std::uint32_t i : division_.subtrees_of(number)) {
    const Box& box = cut_.subtrees[i].bounds;
    cells.push_back({{box.lo.x, box.lo.y, box.lo.z}, number, {box.hi.x, box.hi.y, box.hi.z}, 0});
  }
  const auto placement =
      most_bytes_ > 0 ? wavefront::Placement::copied : wavefront::Placement::in_place_if_possible;
  auto loaded = std::make_unique<LoadedPart>(
      LoadedPart{number, part.n_shared, division_.replicates(),
                 wavefront::SceneBuffers(context_, part.flat, part.wide, placement), part.geometry_bytes(),
                 context_.buffer(CL_MEM_READ_ONLY, cells.size() * sizeof cells[0], "the subtrees"),
                 static_cast<std::uint32_t>(cells.size())});
  if (!cells.empty())
    context_.queues().front().enqueueWriteBuffer(loaded->subtrees, CL_TRUE, 0, cells.size() * sizeof cells[0],
                                                 cells.data());
  ++n_loads_;
  return loaded;
}

void PartStore::make_room(std::size_t bytes) {
  if (most_bytes_ == 0) return;
  while (!loaded_.empty() && bytes_ + bytes > most_bytes_) {
    bytes_ -= loaded_.back()->bytes;
    loaded_.pop_back();
  }
}

const LoadedPart& PartStore::get(std::uint32_t part) {
  const auto found = std::find_if(loaded_.begin(), loaded_.end(),
                                  [part](const auto& loaded) { return loaded->number == part; });
  if (found != loaded_.end()) {
    loaded_.splice(loaded_.begin(), loaded_, found);
    return *loaded_.front();
  }
  make_room(division_.parts[part].geometry_bytes());
  loaded_.push_front(load(part));
  bytes_ += loaded_.front()->bytes;
  peak_bytes_ = std::max(peak_bytes_, bytes_);
  return *loaded_.front();
}

}  // namespace kdray::odprt
