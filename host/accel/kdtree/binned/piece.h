// What    The memory for references of the tree's top: a cell's are in pieces, and a piece is divided in
//         place, as quicksort does. Additional references, of what a plane cuts, go to memory of their own.
// Why     Memory that is touched for the first time costs many times what warm memory costs: two copies of
//         each level took a tenth of the build.
#pragma once

#include <algorithm>
#include <list>
#include <mutex>
#include <span>

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/reference.h"
#include "base/memory.h"

namespace kdray::kdtree::binned {

inline constexpr std::size_t kTaskRefs = 16384;  // references to a task, and to a piece, at most

// References of one cell that lie together, and their hull. There is space for one more than the piece can
// have, since partitions also write behind the last.
struct Piece {
  BoundedRef* first = nullptr;
  std::size_t n = 0, capacity = 0;
  Bounds hull = no_bounds();

  std::span<BoundedRef> refs() const { return {first, n}; }

  // Return whether all references go to one side, so that none need be looked at. What lies in a plane is
  // below it.
  bool is_below(const Plane& plane) const { return hull.hi[plane.axis] <= plane.position; }
  bool is_above(const Plane& plane) const { return hull.lo[plane.axis] > plane.position; }
};

// Returns the piece behind the references that a division left below the plane; those above may fill it.
inline Piece rest_of(const Piece& whole, std::size_t n_below) {
  return {whole.first + n_below + 1, 0, whole.capacity - n_below - 1, no_bounds()};
}
inline std::size_t most_in(const Piece& piece) {
  return piece.capacity == 0 ? 0 : piece.capacity - 1;
}

// Memory for pieces, for all threads; freed with the pool.
class PiecePool {
 public:
  explicit PiecePool(std::size_t n_refs) { add_chunk(n_refs); }

  // Returns an empty piece with space for n references.
  Piece take(std::size_t n) {
    const std::lock_guard lock(mutex_);
    if (left_ < n + 1) add_chunk(std::max(n + 1, kChunk));
    const Piece piece{next_, 0, n + 1, no_bounds()};
    next_ += n + 1;
    left_ -= n + 1;
    return piece;
  }

 private:
  static constexpr std::size_t kChunk = std::size_t{1} << 16;

  void add_chunk(std::size_t n_refs) {
    next_ = chunks_.emplace_back(n_refs).data();
    left_ = n_refs;
  }

  std::mutex mutex_;
  std::list<RawVector<BoundedRef>> chunks_;
  BoundedRef* next_ = nullptr;
  std::size_t left_ = 0;
};

}  // namespace kdray::kdtree::binned
