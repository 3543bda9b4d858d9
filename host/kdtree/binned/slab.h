// What    Memory for the references of the tree's top: slabs of a task's size, used again while they are warm.
#pragma once

#include <tbb/concurrent_queue.h>

#include <memory>
#include <vector>

#include "base/raw_vector.h"
#include "kdtree/reference.h"

namespace kdray::kdtree::binned {

inline constexpr std::size_t kTaskRefs = 16384;  // references to a task, at most

// What a task writes: the parts below a plane and those above it. A place has one slot more than it can have references.
struct Slab {
  RawVector<BoundedRef> below = RawVector<BoundedRef>(kTaskRefs + 1),
                        above = RawVector<BoundedRef>(kTaskRefs + 1);
};

// References of one cell that lie together in a slab, which they keep.
struct Piece {
  std::shared_ptr<Slab> slab;
  BoundedRef* first = nullptr;
  std::size_t n = 0;

  std::span<BoundedRef> refs() const { return {first, n}; }
};

// Slabs come back when the last piece in them is gone. The pool must outlive its pieces.
class SlabPool {
 public:
  std::shared_ptr<Slab> take() {
    Slab* slab = nullptr;
    if (!free_.try_pop(slab)) slab = new Slab;
    return {slab, [this](Slab* s) { free_.push(s); }};
  }
  SlabPool() = default;
  SlabPool(const SlabPool&) = delete;
  SlabPool& operator=(const SlabPool&) = delete;
  ~SlabPool() {
    for (Slab* slab = nullptr; free_.try_pop(slab);) delete slab;
  }

 private:
  tbb::concurrent_queue<Slab*> free_;
};

}  // namespace kdray::kdtree::binned
