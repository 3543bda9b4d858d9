// What    The scene on a device as the probes ask it: the closest hit by any walk, and where the rays that
//         leave a hit begin, by the code that renders. All in the scene's own space (math/local_space.h):
//         origins are not rounded on the way.
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

// `prepared` as if the file had been in the scene's own space, which is then the world's.
prepare::Prepared in_local_space(prepare::Prepared prepared);

class Tracer {
 public:
  // `scene`: in_local_space's; it must live as long.
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
