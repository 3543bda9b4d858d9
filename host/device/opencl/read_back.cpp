#include "device/opencl/read_back.h"

#include <algorithm>

#include "device/opencl/pinned.h"

namespace kdray::device {

void read_pieces(const Context& context, cl::CommandQueue& queue, const cl::Buffer& buffer,
                 std::span<const Piece> pieces, const std::function<void(std::size_t, const void*)>& take) {
  if (pieces.empty()) return;
  const std::size_t largest = std::ranges::max_element(pieces, {}, &Piece::n)->n;
  const std::size_t bytes = std::max(largest, kPieceBytes);  // so that other films find it large enough
  const Pinned staging[] = {{context, queue, bytes}, {context, queue, pieces.size() > 1 ? bytes : 1}};
  cl::Event arrived[2];
  const auto begin = [&](std::size_t i) {
    queue.enqueueReadBuffer(buffer, CL_FALSE, pieces[i].first, pieces[i].n, staging[i % 2].memory(), nullptr,
                            &arrived[i % 2]);
    queue.flush();
  };
  try {
    begin(0);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (i + 1 < pieces.size()) begin(i + 1);
      arrived[i % 2].wait();
      take(i, staging[i % 2].memory());
    }
  } catch (...) {
    queue.finish();
    throw;
  }
}

}  // namespace kdray::device
