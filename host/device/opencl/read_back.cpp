#include "device/opencl/read_back.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace kdray::device {

namespace {

// Pinned memory, mapped for good.
struct Pinned {
  cl::Buffer buffer;
  void* memory = nullptr;
  std::size_t bytes = 0;
};

// Contexts are never destroyed (context.h), so their addresses name them. Neither is this, on purpose.
struct PinnedSpares {
  std::mutex mutex;
  std::map<cl_context, std::vector<Pinned>> of;
};
PinnedSpares& pinned_spares() {
  static auto* all = new PinnedSpares;
  return *all;
}

// Pinned memory of at least so many bytes, for one reader at a time.
class Staging {
 public:
  Staging(const Context& context, cl::CommandQueue& queue, std::size_t bytes) {
    {
      const std::lock_guard lock(pinned_spares().mutex);
      free_ = &pinned_spares().of[context.get()()];
      const auto enough = std::ranges::find_if(*free_, [&](const Pinned& p) { return p.bytes >= bytes; });
      if (enough != free_->end()) {
        pinned_ = std::move(*enough);
        free_->erase(enough);
        return;
      }
    }
    pinned_.bytes = std::max(bytes, kPieceBytes);
    pinned_.buffer = cl::Buffer(context.get(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, pinned_.bytes);
    pinned_.memory =
        queue.enqueueMapBuffer(pinned_.buffer, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, pinned_.bytes);
  }
  ~Staging() {
    const std::lock_guard lock(pinned_spares().mutex);
    free_->push_back(std::move(pinned_));
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  void* memory() const { return pinned_.memory; }

 private:
  std::vector<Pinned>* free_;
  Pinned pinned_;
};

}  // namespace

void read_pieces(const Context& context, cl::CommandQueue& queue, const cl::Buffer& buffer,
                 std::span<const Piece> pieces, const std::function<void(std::size_t, const void*)>& take) {
  if (pieces.empty()) return;
  const std::size_t largest = std::ranges::max_element(pieces, {}, &Piece::n)->n;
  const Staging staging[] = {{context, queue, largest}, {context, queue, pieces.size() > 1 ? largest : 0}};
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
