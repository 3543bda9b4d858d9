#include "bench/embree/build.h"

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
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> flags;
};

Buffers triangle_buffers(const scene::Scene& scene, const scene::Geometry& geometry) {
  Buffers b;
  b.vertices.reserve(3 * scene.vertices.size() + kPadding);
  for (const dvec3& v : scene.vertices) {
    const vec3 local(geometry.space.local(v));
    b.vertices.insert(b.vertices.end(), {local.x, local.y, local.z});
  }
  b.indices.reserve(3 * geometry.triangles.size());
  for (const std::uint32_t source : geometry.sources)
    for (const std::uint32_t v : scene.triangles[source].vertex) b.indices.push_back(v);
  b.vertices.resize(b.vertices.size() + kPadding);
  return b;
}

void add_point(Buffers& b, const vec3& p, float radius) {
  b.vertices.insert(b.vertices.end(), {p.x, p.y, p.z, radius});
}

Buffers sphere_buffers(const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::SphereGeometry& s : geometry.spheres) add_point(b, s.center, s.radius);
  return b;
}

Buffers cone_buffers(const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::ConeGeometry& c : geometry.cones) {
    b.indices.push_back(static_cast<std::uint32_t>(b.vertices.size() / 4));
    b.flags.push_back(kOpenCone);
    add_point(b, c.base, c.base_radius);
    add_point(b, c.apex, c.apex_radius);
  }
  return b;
}

class EmbreeBuild {
 public:
  EmbreeBuild(const scene::Scene& scene, const scene::Geometry& geometry)
      : device_(open_embree()),
        triangles_(triangle_buffers(scene, geometry)),
        spheres_(sphere_buffers(geometry)),
        cones_(cone_buffers(geometry)),
        n_vertices_(scene.vertices.size()) {}
  ~EmbreeBuild() { rtcReleaseDevice(device_); }
  EmbreeBuild(const EmbreeBuild&) = delete;
  EmbreeBuild& operator=(const EmbreeBuild&) = delete;

  BuildTimes run() const {
    const RTCScene made = rtcNewScene(device_);
    rtcSetSceneBuildQuality(made, RTC_BUILD_QUALITY_MEDIUM);
    if (!triangles_.indices.empty()) attach_triangles(made);
    if (!spheres_.vertices.empty()) attach_spheres(made);
    if (!cones_.indices.empty()) attach_cones(made);
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

  static void attach(RTCScene into, RTCGeometry g) {
    rtcCommitGeometry(g);
    rtcAttachGeometry(into, g);
    rtcReleaseGeometry(g);
  }

  void attach_triangles(RTCScene into) const {
    const RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    share(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, triangles_.vertices.data(), 12, n_vertices_);
    share(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangles_.indices.data(), 12,
          triangles_.indices.size() / 3);
    attach(into, g);
  }

  void attach_spheres(RTCScene into) const {
    const RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    share(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, spheres_.vertices.data(), 16,
          spheres_.vertices.size() / 4);
    attach(into, g);
  }

  void attach_cones(RTCScene into) const {
    const RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE);
    share(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, cones_.vertices.data(), 16,
          cones_.vertices.size() / 4);
    share(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, cones_.indices.data(), 4, cones_.indices.size());
    share(g, RTC_BUFFER_TYPE_FLAGS, RTC_FORMAT_UCHAR, cones_.flags.data(), 1, cones_.flags.size());
    attach(into, g);
  }

  RTCDevice device_;
  Buffers triangles_, spheres_, cones_;
  std::size_t n_vertices_;
};

}  // namespace

TimedBuild embree_build(const scene::Scene& scene, const scene::Geometry& geometry) {
  return [build = std::make_shared<EmbreeBuild>(scene, geometry)] { return build->run(); };
}

}  // namespace kdray::bench
