// What    Reading a buffer back piece by piece: the next piece is on its way while one is looked at.
// Why     Through pinned memory: mapping a buffer, and reading into pages that were never touched, goes at
//         2 GB/s on an H100.
// Errors  cl::Error, and what `take` throws; by then no command writes to the host's memory any more.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

// Memory of the host that a device with memory of its own reads and writes at the full speed of the bus (20
// to 50 GB/s on H100s), while the host does something else. Why: It takes milliseconds to make, so it is
// kept when its owner has gone. Errors: cl::Error. Threads: One owner at a time.
class Pinned {
 public:
  // Takes memory that was kept, of at least so many bytes, or makes some.
  Pinned(const Context& context, cl::CommandQueue& queue, std::size_t bytes);
  // No command may be using it.
  ~Pinned();
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

  void* memory() const { return block_.memory; }

  // Mapped for good.
  struct Block {
    cl::Buffer buffer;
    void* memory = nullptr;
    std::size_t bytes = 0;
  };

 private:
  std::vector<Block>* kept_;  // where it goes back to
  Block block_;
};

// Of a buffer, in bytes.
struct Piece {
  std::size_t first, n;
};

// How large pieces should be: so large that waiting for each is little beside it (a film of 25 MB takes an
// H100's host 1.6 ms in pieces of 2 MiB, 1.1 ms in these).
constexpr std::size_t kPieceBytes = std::size_t{8} << 20;

// Calls take(i, memory) for each piece in turn; the memory holds piece i until it returns.
void read_pieces(const Context& context, cl::CommandQueue& queue, const cl::Buffer& buffer,
                 std::span<const Piece> pieces, const std::function<void(std::size_t, const void*)>& take);

}  // namespace kdray::device
