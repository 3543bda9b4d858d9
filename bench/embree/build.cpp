#include "bench/embree/build.h"

#include <fmt/format.h>

#include <array>
#include <memory>

#include "base/error.h"
#include "bench/embree/kinds.h"
#include "bench/embree/library.h"

namespace kdray::bench::embree {

namespace {

class Build {
 public:
  Build(const Library& embree, const scene::Scene& scene, const scene::Geometry& geometry)
      : embree_(embree), device_(open(embree)) {
    primitives::for_each_kind([&](auto kind) { buffers_[kind.kNumber] = buffers_of(kind, scene, geometry); });
  }
  ~Build() { embree_.release_device(device_); }
  Build(const Build&) = delete;
  Build& operator=(const Build&) = delete;

  BuildTimes run() const {
    const Scene made = embree_.new_scene(device_);
    embree_.set_scene_build_quality(made, BuildQuality::medium);
    primitives::for_each_kind([&](auto kind) { attach(made, kind); });
    const BuildClock clock;
    embree_.commit_scene(made);
    const BuildTimes times{clock.wall(), 0, clock.cpu()};
    embree_.release_scene(made);
    if (embree_.get_device_error(device_) != 0) throw Error(ErrorCode::internal, "Embree refuses the scene");
    return times;
  }

 private:
  void share(Geometry g, BufferType type, Format format, const void* data, std::size_t stride,
             std::size_t n) const {
    embree_.set_shared_geometry_buffer(g, type, 0, format, data, 0, stride, n);
  }

  template <class Kind>
  void attach(Scene into, Kind kind) const {
    const Buffers& b = buffers_[Kind::kNumber];
    if (b.n_vertices == 0) return;
    const Geometry g = embree_.new_geometry(device_, embree_type(kind));
    constexpr std::size_t kFloats = Kind::kIsShape ? 4 : 3;
    share(g, BufferType::vertex, Kind::kIsShape ? Format::float4 : Format::float3, b.vertices.data(),
          kFloats * sizeof(float), b.n_vertices);
    if (!b.normals.empty())
      share(g, BufferType::normal, Format::float3, b.normals.data(), 3 * sizeof(float), b.n_vertices);
    if (!Kind::kIsShape)
      share(g, BufferType::index, Format::uint3, b.indices.data(), 3 * sizeof(std::uint32_t),
            b.indices.size() / 3);
    else if (!b.indices.empty())
      share(g, BufferType::index, Format::uint, b.indices.data(), sizeof(std::uint32_t), b.indices.size());
    if (!b.flags.empty()) share(g, BufferType::flags, Format::uchar, b.flags.data(), 1, b.flags.size());
    embree_.commit_geometry(g);
    embree_.attach_geometry(into, g);
    embree_.release_geometry(g);
  }

  const Library& embree_;
  Device device_;
  std::array<Buffers, primitives::kKinds> buffers_;
};

}  // namespace

}  // namespace kdray::bench::embree

namespace kdray::bench {

std::vector<EmbreeBuild> embree_builds(const scene::Scene& scene, const scene::Geometry& geometry) {
  std::vector<EmbreeBuild> builds;
  for (const embree::Library& library : embree::libraries())
    builds.push_back(
        {fmt::format("Embree {} medium", library.major),
         [build = std::make_shared<embree::Build>(library, scene, geometry)] { return build->run(); }});
  return builds;
}

}  // namespace kdray::bench
