#include "engine/odprt/replicate.h"

#include <algorithm>
#include <numeric>

namespace kdray::odprt {

std::vector<bool> replicate(std::span<const double> visits, std::span<const std::uint64_t> bytes,
                            std::uint64_t most_bytes) {
  std::vector<std::size_t> order(visits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return visits[a] * static_cast<double>(bytes[b]) > visits[b] * static_cast<double>(bytes[a]);
  });
  std::vector<bool> chosen(visits.size());
  for (const std::size_t i : order) {
    if (bytes[i] > most_bytes || visits[i] <= 0) continue;
    most_bytes -= bytes[i];
    chosen[i] = true;
  }
  return chosen;
}

}  // namespace kdray::odprt
