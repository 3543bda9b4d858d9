#include "engine/wavefront/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

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
  for (const std::string& name : names)
    for (const Plane& p : kPlaneTable)
      if (name == p.channel) planes.push_back(p);
  return planes;
}

// A queue with its kernel and buffers, which renders one run of pixels after the other.
class PixelRuns {
 public:
  PixelRuns(const ChannelQueue& on, const layout::Frame& frame, layout::Features features,
            Precision precision, std::size_t most)
      : queue_(on.queue),
        // The binary tree has no instances.
        stage_(on.programs.kernel<K>(features | KDRAY_FEATURE_COST,
                                     features & KDRAY_FEATURE_INSTANCES ? Traversal::wide : Traversal::binary,
                                     precision)),
        frame_(on.context.buffer(CL_MEM_READ_ONLY, sizeof frame, "the frame")),
        out_(on.context.buffer(CL_MEM_WRITE_ONLY, most * kPlanes * sizeof(float), "the channels")),
        values_(most * kPlanes) {
    queue_.enqueueWriteBuffer(frame_, CL_TRUE, 0, sizeof frame, &frame);
    on.scene.set_arguments(stage_);
    stage_.set(K::frame, frame_).set(K::channels, out_);
  }

  void start(std::size_t first, std::size_t n) {
    first_ = first;
    n_ = n;
    stage_.set(K::first_pixel, static_cast<cl_uint>(first)).set(K::n_pixels, static_cast<cl_uint>(n));
    stage_.launch(queue_, (n + KDRAY_LANES - 1) / KDRAY_LANES, kWorkGroup);
    queue_.flush();
  }

  // Waits for what was started, if anything was.
  void take(const LocalSpace& space, std::span<const Plane> planes, std::vector<image::Channel>& channels) {
    const std::size_t n = std::exchange(n_, 0);
    if (n == 0) return;
    queue_.enqueueReadBuffer(out_, CL_TRUE, 0, n * kPlanes * sizeof(float), values_.data());
    for (std::size_t i = 0; i < n; ++i) {
      float& depth = values_[i * kPlanes];
      if (std::isnan(depth))
        throw Error(ErrorCode::internal,
                    "a ray overflowed the traversal's stack; please report it with the scene");
      depth = static_cast<float>(space.world_length(depth));
    }
    for (std::size_t c = 0; c < planes.size(); ++c)
      for (std::size_t i = 0; i < n; ++i)
        channels[c].values[first_ + i] = values_[i * kPlanes + planes[c].index];
  }

 private:
  using K = kernels::Channels;
  cl::CommandQueue queue_;
  Stage<K> stage_;
  cl::Buffer frame_, out_;
  std::vector<float> values_;
  std::size_t first_ = 0, n_ = 0;
};

}  // namespace

void check_channels(std::span<const std::string> names) {
  for (const std::string& name : names)
    if (name != "queue" && name != "samples" && wanted_planes({&name, 1}).empty())
      throw Error(ErrorCode::usage,
                  fmt::format("there is no channel '{}'; there are depth, normal, primitive, instance, "
                              "cost, queue and samples",
                              name));
}

std::vector<image::Channel> render_channels(std::span<const ChannelQueue> queues, const layout::Frame& frame,
                                            const LocalSpace& space, layout::Features features,
                                            Precision precision, std::span<const std::string> names) {
  const std::vector<Plane> planes = wanted_planes(names);
  const std::size_t n_pixels = std::size_t{frame.width} * frame.height;
  std::vector<image::Channel> channels;
  for (const Plane& p : planes) channels.push_back({p.name, std::vector<float>(n_pixels)});
  if (planes.empty()) return channels;

  const std::size_t at_once = std::min((n_pixels + queues.size() - 1) / queues.size(), kPixelsPerLaunch);
  device::checked("rendering the channels", [&] {
    std::deque<PixelRuns> all;
    for (const ChannelQueue& queue : queues) all.emplace_back(queue, frame, features, precision, at_once);
    for (std::size_t first = 0; first < n_pixels;) {
      for (PixelRuns& runs : all) {
        const std::size_t n = std::min(at_once, n_pixels - first);
        if (n > 0) runs.start(first, n);
        first += n;
      }
      for (PixelRuns& runs : all) runs.take(space, planes, channels);
    }
  });
  return channels;
}

}  // namespace kdray::wavefront
