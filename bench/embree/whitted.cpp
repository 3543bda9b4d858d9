// What    Whole frames by Embree (embree.h).

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/timer.h"
#include "bench/embree/embree.h"
#include "bench/embree/packets.h"
#include "bench/embree/scenes.h"
#include "bench/embree/workers.h"
#include "bench/workload/pixel_order.h"
#include "bench/workload/rays.h"

namespace kdray::bench::embree {

namespace {

constexpr int kTile = 16;
constexpr float kOff = 0x1p-6f;  // that rays begin off a surface; a scene reaches to 2^10

struct Path {
  vec3 origin, direction, weight;
  std::uint32_t pixel;
};

// Of unit length: Embree's cones are wrong without.
struct ShadowRay {
  vec3 origin, direction, color;
  float distance;
  std::uint32_t pixel;
};

// What a thread works with.
struct Bench {
  std::vector<Path> now, next;
  std::vector<std::vector<ShadowRay>> to_lights;
  std::uint64_t n_rays = 0;
};

struct Surface {
  vec3 point, incoming, ng, ns;  // normals towards the viewer
  bool entering;
  const scene::Material* material;
};

float largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

vec3 mirrored(const vec3& d, const vec3& n) {
  return d - 2 * glm::dot(d, n) * n;
}

// Materials and vertex normals of primitives by Embree's numbers.
struct Looks {
  std::array<std::vector<std::uint32_t>, primitives::kKinds> material;
  std::vector<std::array<vec3, 3>> normals;  // of each triangle; none where no triangle has them

  explicit Looks(const scene::Scene& scene) {
    const scene::Geometry geometry = scene::make_geometry(scene);
    primitives::for_each_kind([&](auto kind) {
      for (const auto& p : decltype(kind)::of(geometry))
        if constexpr (decltype(kind)::kIsShape)
          material[kind.kNumber].push_back(decltype(kind)::of(scene)[p.source].material);
    });
    for (const std::uint32_t source : geometry.sources) add(scene, scene.triangles[source]);
    if (scene.normals.empty()) normals.clear();
  }

 private:
  void add(const scene::Scene& scene, const scene::Triangle& t) {
    material[primitives::TriangleKind::kNumber].push_back(t.material);
    auto& n = normals.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      n[i] = t.normal[i] == scene::kNone ? vec3(0) : scene.normals[t.normal[i]];
  }
};

class Whitted {
 public:
  Whitted(const Library& library, const scene::Scene& scene, const EmbreeFrameOptions& options)
      : scene_(scene), options_(options), embree_(library, scene), looks_(scene), arena_(options.threads) {
    for (const scene::Light& light : scene.lights)
      lights_.push_back(vec3(embree_.space().local(light.position)));
    const CameraBasis view(*scene.camera);
    eye_ = vec3(embree_.space().local(scene.camera->from));
    forward_ = vec3(view.forward);
    right_ = vec3(view.right * (view.half_height * options.width / options.height));
    up_ = vec3(view.up * view.half_height);
  }

  EmbreePicture render() {
    EmbreePicture picture;
    picture.rgb.assign(static_cast<std::size_t>(options_.width) * options_.height, vec3(0));
    const int across = (options_.width + kTile - 1) / kTile, down = (options_.height + kTile - 1) / kTile;
    tbb::enumerable_thread_specific<Bench> benches;
    const Timer timer;
    arena_.execute([&] {
      tbb::parallel_for(0, across * down, [&](int tile) {
        const FlushedDenormals flush;
        render_tile(tile % across * kTile, tile / across * kTile, benches.local(), picture.rgb);
      });
    });
    picture.seconds = timer.seconds();
    for (const Bench& bench : benches) picture.n_rays += bench.n_rays;
    return picture;
  }

 private:
  void render_tile(int left, int top, Bench& bench, std::vector<vec3>& rgb) {
    static const std::vector<Pixel> order = morton_order(kTile);
    bench.now.clear();
    for (const Pixel& p : order)
      if (left + p.x < options_.width && top + p.y < options_.height)
        bench.now.push_back(eye(left + p.x, top + p.y));
    for (int depth = 1; !bench.now.empty(); ++depth) {
      bench.next.clear();
      bench.to_lights.resize(lights_.size());
      for (auto& rays : bench.to_lights) rays.clear();
      trace(bench, depth, rgb);
      for (const auto& rays : bench.to_lights) add_lit(rays, bench, rgb);
      std::swap(bench.now, bench.next);
    }
  }

  Path eye(int x, int y) const {
    const float u = 2 * (static_cast<float>(x) + 0.5f) / static_cast<float>(options_.width) - 1;
    const float v = 1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(options_.height);
    return {eye_, glm::normalize(forward_ + u * right_ + v * up_), vec3(1),
            static_cast<std::uint32_t>(y * options_.width + x)};
  }

  void trace(Bench& bench, int depth, std::vector<vec3>& rgb) {
    Query query(embree_.library(), depth == 1);
    bench.n_rays += bench.now.size();
    const auto put = [&](Rays<16>& rays, unsigned lane, std::size_t i) {
      const Path& path = bench.now[i];
      put_ray(rays, lane, &path.origin.x, &path.direction.x, depth == 1 ? 0 : kOff);
    };
    const auto take = [&](const RayHits<16>& packed, unsigned lane, std::size_t i) {
      const Path& path = bench.now[i];
      if (packed.hit.geometry[lane] == kNone)
        rgb[path.pixel] += path.weight * scene_.background;
      else
        shade(path, surface(path, packed, lane), depth, bench, rgb);
    };
    trace_rays<16, false>(embree_.get(false), query, 0, bench.now.size(), put, take);
  }

  Surface surface(const Path& path, const RayHits<16>& packed, unsigned lane) const {
    const std::uint32_t kind = packed.hit.geometry[lane], primitive = packed.hit.primitive[lane];
    Surface s;
    s.point = path.origin + packed.ray.t_far[lane] * path.direction;
    s.incoming = path.direction;
    const vec3 outward = glm::normalize(
        vec3(packed.hit.normal[0][lane], packed.hit.normal[1][lane], packed.hit.normal[2][lane]));
    s.entering = glm::dot(outward, s.incoming) <= 0;
    s.ng = s.ns = s.entering ? outward : -outward;
    if (kind == primitives::TriangleKind::kNumber && !looks_.normals.empty())
      s.ns = smooth(looks_.normals[primitive], packed.hit.u[lane], packed.hit.v[lane], s.ng);
    s.material = &scene_.materials[looks_.material[kind][primitive]];
    return s;
  }

  static vec3 smooth(const std::array<vec3, 3>& n, float u, float v, const vec3& ng) {
    const vec3 sum = (1 - u - v) * n[0] + u * n[1] + v * n[2];
    if (sum == vec3(0)) return ng;
    const vec3 unit = glm::normalize(sum);
    return glm::dot(unit, ng) >= 0 ? unit : -unit;
  }

  void shade(const Path& path, const Surface& s, int depth, Bench& bench, std::vector<vec3>& rgb) const {
    const scene::Material& m = *s.material;
    rgb[path.pixel] += path.weight * (m.emission + m.ambient * scene_.ambient);
    for (std::size_t i = 0; i < lights_.size(); ++i) aim(path, s, i, bench);
    if (depth >= options_.depth) return;
    vec3 reflect = m.reflect;
    if (largest(m.transmit) > 0 && !refract(path, s, bench)) reflect += m.transmit;
    vec3 r = mirrored(s.incoming, s.ns);
    if (glm::dot(r, s.ng) <= 0) r = mirrored(r, s.ng);
    go_on(path, s, r, reflect, bench);
  }

  void aim(const Path& path, const Surface& s, std::size_t i, Bench& bench) const {
    const scene::Light& light = scene_.lights[i];
    const vec3 way = lights_[i] - s.point;
    const float distance = glm::length(way);
    const vec3 l = way / distance;
    const float cosine = glm::dot(s.ns, l);
    if (!(cosine > 0)) return;
    const scene::Material& m = *s.material;
    const double world = embree_.space().world_length(distance);
    const auto fade = static_cast<float>(
        1 / (light.attenuation.x + light.attenuation.y * world + light.attenuation.z * world * world));
    const float aligned = glm::dot(mirrored(-l, s.ns), -s.incoming);
    vec3 color = cosine * m.diffuse;
    if (aligned > 0 && largest(m.specular) > 0) color += std::pow(aligned, m.shine) * m.specular;
    color *= fade * light.color;
    if (largest(color) > 0)
      bench.to_lights[i].push_back({s.point, l, path.weight * color, distance, path.pixel});
  }

  // Returns false where all is reflected.
  bool refract(const Path& path, const Surface& s, Bench& bench) const {
    const scene::Material& m = *s.material;
    const float eta = s.entering ? 1 / m.index : m.index;
    const float cosine = -glm::dot(s.incoming, s.ns), k = 1 - eta * eta * (1 - cosine * cosine);
    if (k < 0) return false;
    vec3 t = m.index == 1 ? s.incoming : eta * s.incoming + (eta * cosine - std::sqrt(k)) * s.ns;
    if (glm::dot(t, s.ng) >= 0) t = mirrored(t, s.ng);
    go_on(path, s, t, m.transmit, bench);
    return true;
  }

  void go_on(const Path& path, const Surface& s, const vec3& direction, const vec3& share,
             Bench& bench) const {
    const vec3 weight = path.weight * share;
    if (largest(weight) > 0 && largest(weight) >= static_cast<float>(options_.spawn_threshold))
      bench.next.push_back({s.point, glm::normalize(direction), weight, path.pixel});
  }

  void add_lit(const std::vector<ShadowRay>& rays, Bench& bench, std::vector<vec3>& rgb) const {
    Query query(embree_.library(), true);
    bench.n_rays += rays.size();
    const auto put = [&](Rays<16>& packed, unsigned lane, std::size_t i) {
      put_ray(packed, lane, &rays[i].origin.x, &rays[i].direction.x, kOff, rays[i].distance);
    };
    const auto take = [&](const Rays<16>& packed, unsigned lane, std::size_t i) {
      if (packed.t_far[lane] >= 0) rgb[rays[i].pixel] += rays[i].color;
    };
    trace_rays<16, true>(embree_.get(false), query, 0, rays.size(), put, take);
  }

  const scene::Scene& scene_;
  EmbreeFrameOptions options_;
  Scenes embree_;
  Looks looks_;
  tbb::task_arena arena_;
  std::vector<vec3> lights_;  // in Embree's space
  vec3 eye_, forward_, right_, up_;
};

}  // namespace

}  // namespace kdray::bench::embree

namespace kdray::bench {

std::vector<EmbreeFrames> embree_frames(const scene::Scene& scene, const EmbreeFrameOptions& options) {
  std::vector<EmbreeFrames> all;
  for (const embree::Library& library : embree::libraries()) {
    const auto whitted = std::make_shared<embree::Whitted>(library, scene, options);
    all.push_back({fmt::format("Embree {}", library.major), [whitted] { return whitted->render(); }});
  }
  return all;
}

}  // namespace kdray::bench
