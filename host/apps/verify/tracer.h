// What    The scene on a device, for the probes: returns the closest hits by any walk, and where rays that
//         leave a hit begin, both by the code that renders. All is in the scene's own space
//         (base/local_space.h), so that origins are not rounded on the way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/prepare/prepared.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "kdray/kdray.h"
#include "layout/verify.layout.h"

namespace kdray::verify {

// Returns `prepared` as if the file had been in the scene's own space, which is then the world's.
prepare::Prepared in_local_space(prepare::Prepared prepared);

class Tracer {
 public:
  // `scene` comes from in_local_space(), and has to live as long.
  Tracer(const prepare::Prepared& scene, const DeviceOptions& device);

  std::vector<Hit> closest(std::span<const Ray> rays, Traversal traversal = Traversal::automatic);
  std::vector<layout::Departure> departures(std::span<const Ray> rays, std::span<const Hit> hits);

 private:
  const prepare::Prepared& scene_;
  device::Context context_;
  wavefront::SceneBuffers buffers_;
  wavefront::Programs programs_;
  std::vector<std::uint32_t> ref_of_;  // by the primitive's number
};

}  // namespace kdray::verify
