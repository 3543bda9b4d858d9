#include "base/paged.h"
#include "kdray/scene.h"

namespace kdray {

void set_texture_cache(std::uint64_t bytes) {
  set_paged_budget(bytes);
}

}  // namespace kdray
