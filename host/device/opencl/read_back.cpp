#include "device/opencl/read_back.h"

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

namespace kdray::device {

namespace {

// Contexts are never destroyed (context.h), so their addresses name them. Neither is this, on purpose.
struct Kept {
  std::mutex mutex;
  std::map<cl_context, std::vector<Pinned::Block>> of;
};
Kept& kept() {
  static auto* all = new Kept;
  return *all;
}

}  // namespace

Pinned::Pinned(const Context& context, cl::CommandQueue& queue, std::size_t bytes) {
  {
    const std::lock_guard lock(kept().mutex);
    kept_ = &kept().of[context.get()()];
    const auto size_of = [&](const Block& block) {
      return block.bytes >= bytes ? block.bytes : std::numeric_limits<std::size_t>::max();
    };
    const auto least = std::ranges::min_element(*kept_, {}, size_of);
    if (least != kept_->end() && least->bytes >= bytes) {
      block_ = std::move(*least);
      kept_->erase(least);
      return;
    }
  }
  block_.bytes = bytes;
  block_.buffer = cl::Buffer(context.get(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
  block_.memory = queue.enqueueMapBuffer(block_.buffer, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes);
}

Pinned::~Pinned() {
  const std::lock_guard lock(kept().mutex);
  kept_->push_back(std::move(block_));
}

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
