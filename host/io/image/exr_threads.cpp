#include "io/image/exr_threads.h"

#include <ImfThreading.h>

#include <algorithm>
#include <thread>

namespace kdray::image {

int exr_threads() {
  static const int n_threads = [] {
    const int n = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    // 1 thread means none beside the caller's.
    if (Imf::globalThreadCount() == 0 && n > 1) Imf::setGlobalThreadCount(n);
    return n > 1 ? n : 0;
  }();
  return n_threads;
}

}  // namespace kdray::image
