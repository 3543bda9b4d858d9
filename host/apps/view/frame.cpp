#include "apps/view/frame.h"

#include <cstdint>

namespace kdray::view {

Bytes make_frame(std::string_view head, std::string_view picture) {
  std::string bytes;
  bytes.reserve(4 + head.size() + picture.size());
  for (int k = 0; k < 4; ++k) bytes += static_cast<char>(static_cast<std::uint32_t>(head.size()) >> (8 * k));
  bytes += head;
  bytes += picture;
  return std::make_shared<const std::string>(std::move(bytes));
}

}  // namespace kdray::view
