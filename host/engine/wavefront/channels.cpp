#include "engine/wavefront/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "device/opencl/opencl_error.h"
#include "engine/wavefront/stage.h"
#include "layout/features.h"
#include "layout/rays.layout.h"

namespace kdray::wavefront {

namespace {

constexpr std::size_t kPlanes = 7;                 // floats per pixel that the kernel writes
constexpr std::size_t kPixelsPerLaunch = 1 << 20;  // 28 MiB of buffer, whatever the picture's size
constexpr std::size_t kWorkGroup = 16;             // items of KDRAY_LANES pixels

struct Plane {
  const char* channel;  // as the user names it
  const char* name;     // image::Channel's
  std::size_t index;
};
constexpr Plane kPlaneTable[kPlanes] = {{"depth", "depth", 0},         {"normal", "normal.x", 1},
                                        {"normal", "normal.y", 2},     {"normal", "normal.z", 3},
                                        {"primitive", "primitive", 4}, {"cost", "cost", 5},
                                        {"instance", "instance", 6}};

std::vector<Plane> wanted_planes(std::span<const std::string> names) {
  std::vector<Plane> planes;
  for (const std::string& name : names) {
    const std::size_t before = planes.size();
    for (const Plane& p : kPlaneTable)
      if (name == p.channel) planes.push_back(p);
    if (planes.size() == before)
      throw Error(ErrorCode::usage,
                  fmt::format("there is no channel '{}'; there are depth, normal, primitive, instance, "
                              "cost, queue and samples",
                              name));
  }
  return planes;
}

}  // namespace

std::vector<image::Channel> render_channels(const device::Context& context, const SceneBuffers& scene,
                                            Programs& programs, const layout::Frame& frame,
                                            const LocalSpace& space, layout::Features features,
                                            Precision precision, std::span<const std::string> names) {
  const std::vector<Plane> planes = wanted_planes(names);
  const std::size_t n_pixels = std::size_t{frame.width} * frame.height;
  std::vector<image::Channel> channels;
  for (const Plane& p : planes) channels.push_back({p.name, std::vector<float>(n_pixels)});
  if (planes.empty()) return channels;

  const std::size_t chunk = std::min(n_pixels, kPixelsPerLaunch);
  const cl::Buffer out = context.buffer(CL_MEM_WRITE_ONLY, chunk * kPlanes * sizeof(float), "the channels");
  const cl::Buffer frame_buffer = context.buffer(CL_MEM_READ_ONLY, sizeof frame, "the frame");
  using K = kernels::Channels;
  // The binary tree has no instances.
  const Traversal walk = features & KDRAY_FEATURE_INSTANCES ? Traversal::wide : Traversal::binary;
  Stage stage(programs.kernel<K>(features | KDRAY_FEATURE_COST, walk, precision));
  cl::CommandQueue queue = context.queues().front();
  std::vector<float> values(chunk * kPlanes);
  device::checked("rendering the channels", [&] {
    queue.enqueueWriteBuffer(frame_buffer, CL_TRUE, 0, sizeof frame, &frame);
    scene.set_arguments(stage);
    stage.set(K::frame, frame_buffer).set(K::channels, out);
    for (std::size_t first = 0; first < n_pixels; first += chunk) {
      const std::size_t n = std::min(chunk, n_pixels - first);
      stage.set(K::first_pixel, static_cast<cl_uint>(first)).set(K::n_pixels, static_cast<cl_uint>(n));
      stage.launch(queue, (n + KDRAY_LANES - 1) / KDRAY_LANES, kWorkGroup);
      queue.enqueueReadBuffer(out, CL_TRUE, 0, n * kPlanes * sizeof(float), values.data());
      for (std::size_t i = 0; i < n; ++i) {
        float& depth = values[i * kPlanes];
        if (std::isnan(depth))
          throw Error(ErrorCode::internal,
                      "a ray overflowed the traversal's stack; please report it with the scene");
        depth = static_cast<float>(space.world_length(depth));
      }
      for (std::size_t c = 0; c < planes.size(); ++c)
        for (std::size_t i = 0; i < n; ++i)
          channels[c].values[first + i] = values[i * kPlanes + planes[c].index];
    }
  });
  return channels;
}

}  // namespace kdray::wavefront
