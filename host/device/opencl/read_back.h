// What    Reading a buffer back piece by piece: the next piece is on its way while one is looked at.
// Why     Through pinned memory (pinned.h): mapping a buffer, and reading into pages that were never touched,
//         goes at 2 GB/s on an H100.
// Errors  cl::Error, and what `take` throws; by then no command writes to the host's memory any more.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "device/opencl/context.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

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
