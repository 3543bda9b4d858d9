#include "bench/embree/build.h"

#include <array>
#include <memory>

#include "base/error.h"
#include "bench/embree/api.h"
#include "bench/embree/kinds.h"
#include "bench/embree/scenes.h"

namespace kdray::bench {

namespace {

class EmbreeBuild {
 public:
  EmbreeBuild(const scene::Scene& scene, const scene::Geometry& geometry) : device_(open_embree()) {
    primitives::for_each_kind([&](auto kind) { buffers_[kind.kNumber] = buffers_of(kind, scene, geometry); });
  }
  ~EmbreeBuild() { rtcReleaseDevice(device_); }
  EmbreeBuild(const EmbreeBuild&) = delete;
  EmbreeBuild& operator=(const EmbreeBuild&) = delete;

  BuildTimes run() const {
    const RTCScene made = rtcNewScene(device_);
    rtcSetSceneBuildQuality(made, RTC_BUILD_QUALITY_MEDIUM);
    primitives::for_each_kind([&](auto kind) { attach(made, kind); });
    const BuildClock clock;
    rtcCommitScene(made);
    const BuildTimes times{clock.wall(), 0, clock.cpu()};
    rtcReleaseScene(made);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
      throw Error(ErrorCode::internal, "Embree refuses the scene");
    return times;
  }

 private:
  static void share(RTCGeometry g, RTCBufferType type, RTCFormat format, const void* data, std::size_t stride,
                    std::size_t n) {
    rtcSetSharedGeometryBuffer(g, type, 0, format, data, 0, stride, n);
  }

  template <class Kind>
  void attach(RTCScene into, Kind kind) const {
    const Buffers& b = buffers_[Kind::kNumber];
    if (b.n_vertices == 0) return;
    const RTCGeometry g = rtcNewGeometry(device_, embree_type(kind));
    constexpr std::size_t kFloats = Kind::kIsShape ? 4 : 3;
    share(g, RTC_BUFFER_TYPE_VERTEX, Kind::kIsShape ? RTC_FORMAT_FLOAT4 : RTC_FORMAT_FLOAT3,
          b.vertices.data(), kFloats * sizeof(float), b.n_vertices);
    if (!b.normals.empty())
      share(g, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, b.normals.data(), 3 * sizeof(float), b.n_vertices);
    if (!Kind::kIsShape)
      share(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, b.indices.data(), 3 * sizeof(std::uint32_t),
            b.indices.size() / 3);
    else if (!b.indices.empty())
      share(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, b.indices.data(), sizeof(std::uint32_t),
            b.indices.size());
    if (!b.flags.empty())
      share(g, RTC_BUFFER_TYPE_FLAGS, RTC_FORMAT_UCHAR, b.flags.data(), 1, b.flags.size());
    rtcCommitGeometry(g);
    rtcAttachGeometry(into, g);
    rtcReleaseGeometry(g);
  }

  RTCDevice device_;
  std::array<Buffers, primitives::kKinds> buffers_;
};

}  // namespace

TimedBuild embree_build(const scene::Scene& scene, const scene::Geometry& geometry) {
  return [build = std::make_shared<EmbreeBuild>(scene, geometry)] { return build->run(); };
}

}  // namespace kdray::bench
