// What    Memory for the references of the tree's top: slabs of a task's size, used again while they are warm.
#pragma once

#include <tbb/concurrent_queue.h>

#include <array>
#include <list>
#include <memory>
#include <mutex>
#include <span>

#include "base/raw_vector.h"
#include "kdtree/reference.h"

namespace kdray::kdtree::binned {

inline constexpr std::size_t kTaskRefs = 16384;  // references to a task, at most

// What a task writes: the parts below a plane and those above it. A place has one slot more than it can have references.
struct Slab {
  std::array<BoundedRef, kTaskRefs + 1> below, above;
};

// References of one cell that lie together in a slab, which they keep.
struct Piece {
  std::shared_ptr<Slab> slab;
  BoundedRef* first = nullptr;
  std::size_t n = 0;

  std::span<BoundedRef> refs() const { return {first, n}; }
};

// Slabs come back when the last piece in them is gone. The pool must outlive its pieces. Memory is taken for several at a time:
// of four and more it comes in large pages.
class SlabPool {
 public:
  explicit SlabPool(std::size_t at_a_time) : at_a_time_(at_a_time) {}
  std::shared_ptr<Slab> take() {
    Slab* slab = nullptr;
    while (!free_.try_pop(slab)) add_chunk();
    return {slab, [this](Slab* s) { free_.push(s); }};
  }
  SlabPool(const SlabPool&) = delete;
  SlabPool& operator=(const SlabPool&) = delete;

 private:
  void add_chunk() {
    const std::lock_guard lock(mutex_);
    if (!free_.empty()) return;
    auto& chunk = chunks_.emplace_back(at_a_time_);
    for (Slab& slab : chunk) free_.push(&slab);
  }

  const std::size_t at_a_time_;
  std::mutex mutex_;
  std::list<RawVector<Slab>> chunks_;
  tbb::concurrent_queue<Slab*> free_;
};

}  // namespace kdray::kdtree::binned
