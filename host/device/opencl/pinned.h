// What    Memory of the host that a device with memory of its own reads and writes at the full speed of the
//         bus (20 to 50 GB/s on H100s), while the host does something else.
// Why     It takes milliseconds to make, so it is kept when its owner has gone.
// Errors  cl::Error.
// Threads One owner at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

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

}  // namespace kdray::device
