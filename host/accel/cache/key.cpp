#include "accel/cache/key.h"

#include <fmt/format.h>

#include "fingerprint.h"
#include "layout/base.layout.h"
#include "scene/import/read_file.h"

namespace kdray::cache {

Hash key_of(const std::filesystem::path& file, const Hash& content, const TreeOptions& tree,
            const LoadOptions& load) {
  // All options are named here, so that one that is added fails to compile.
  const auto& [quality, max_depth, cost_traverse, cost_intersect, memory_bytes, binary_form] = tree;
  const auto& [smooth_degrees, time, animation, texture_bytes, instances, asset_root] = load;
  // The ending decides how bytes are read; numbers are written so that no bit is lost.
  const std::string text = fmt::format(
      "kdray {}, code {}, compiler {}, layout {}, words of {} bytes\n{} {}\n{}\nquality {}, depth {}, costs "
      "{:a} {:a}, "
      "memory {}, binary {}, smooth {:a}, time {}, animation {}, textures {}, instances {}, assets {}",
      KDRAY_VERSION, KDRAY_FINGERPRINT, __VERSION__, KDRAY_LAYOUT_VERSION, sizeof(void*),
      scene::format_of(file), file.extension().string(), in_hex(content), static_cast<int>(quality),
      max_depth, cost_traverse, cost_intersect, memory_bytes, binary_form, smooth_degrees.value_or(-1),
      time ? fmt::format("{:a}", *time) : "none", animation, texture_bytes, static_cast<int>(instances),
      asset_root.empty() ? "" : std::filesystem::absolute(asset_root).string());
  return hash_of(text);
}

}  // namespace kdray::cache
