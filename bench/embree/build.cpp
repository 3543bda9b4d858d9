#include "bench/embree/build.h"

#include <array>
#include <memory>

#include "base/error.h"
#include "bench/embree/api.h"
#include "bench/embree/scenes.h"

namespace kdray::bench {

namespace {

// Embree reads vectors of 16 bytes, at the end too.
constexpr std::size_t kPadding = 16 / sizeof(float);

struct Buffers {
  std::vector<float> vertices;  // of 3 (triangles) or 4 (with a radius) floats
  std::size_t n_vertices = 0;
  std::vector<float> normals;  // of 3
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> flags;
};

// The buffers of a kind. One that lacks them does not compile.
Buffers buffers_of(primitives::TriangleKind, const scene::Scene& scene, const scene::Geometry& geometry) {
  Buffers b;
  if (geometry.triangles.empty()) return b;
  b.vertices.reserve(3 * scene.vertices.size() + kPadding);
  for (const dvec3& v : scene.vertices) {
    const vec3 local(geometry.space.local(v));
    b.vertices.insert(b.vertices.end(), {local.x, local.y, local.z});
  }
  b.indices.reserve(3 * geometry.triangles.size());
  for (const std::uint32_t source : geometry.sources)
    for (const std::uint32_t v : scene.triangles[source].vertex) b.indices.push_back(v);
  b.n_vertices = scene.vertices.size();
  b.vertices.resize(b.vertices.size() + kPadding);
  return b;
}

void add_point(Buffers& b, const vec3& p, float radius) {
  b.vertices.insert(b.vertices.end(), {p.x, p.y, p.z, radius});
  ++b.n_vertices;
}

Buffers buffers_of(primitives::SphereKind, const scene::Scene&, const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::SphereGeometry& s : geometry.spheres) add_point(b, s.center, s.radius);
  return b;
}

Buffers buffers_of(primitives::ConeKind, const scene::Scene&, const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::ConeGeometry& c : geometry.cones) {
    b.indices.push_back(static_cast<std::uint32_t>(b.n_vertices));
    b.flags.push_back(kOpenCone);
    add_point(b, c.base, c.base_radius);
    add_point(b, c.apex, c.apex_radius);
  }
  return b;
}

Buffers buffers_of(primitives::DiscKind, const scene::Scene&, const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::DiscGeometry& d : geometry.discs) {
    add_point(b, d.center, d.radius);
    b.normals.insert(b.normals.end(), {d.normal.x, d.normal.y, d.normal.z});
  }
  if (!b.normals.empty()) b.normals.resize(b.normals.size() + kPadding);
  return b;
}

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
