#include "bench/embree/embree.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <latch>
#include <limits>
#include <thread>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "base/timer.h"
#include "bench/embree/scenes.h"

namespace kdray::bench {

namespace {

constexpr std::size_t kChunk = 4096;  // rays that a thread draws at a time
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Setting {
  bool robust, coherent, stream;
};

// Embree's manual asks this of every thread that traces.
void flush_denormals() {
#if defined(__SSE__)
  _mm_setcsr(_mm_getcsr() | 0x8040);  // flush to zero, denormals are zero
#endif
}

// Runs `trace_chunk(first, end)` over [0, n) on threads that wait for the clock to start. Seconds.
template <class TraceChunk>
double on_threads(int n_threads, std::size_t n, std::size_t chunk, const TraceChunk& trace_chunk) {
  std::atomic<std::size_t> next{0};
  std::latch ready(n_threads), start(1);
  std::vector<std::thread> threads;
  for (int i = 0; i < n_threads; ++i)
    threads.emplace_back([&] {
      flush_denormals();
      ready.count_down();
      start.wait();
      for (std::size_t first; (first = next.fetch_add(chunk)) < n;)
        trace_chunk(first, std::min(first + chunk, n));
    });
  ready.wait();
  const Timer timer;
  start.count_down();
  for (std::thread& t : threads) t.join();
  return timer.seconds();
}

void set_ray(RTCRayN* rays, unsigned n, unsigned i, const Ray& ray, const LocalSpace& space) {
  const vec3 center(space.center);
  const auto scale = static_cast<float>(space.scale);
  RTCRayN_org_x(rays, n, i) = (ray.origin[0] - center.x) * scale;
  RTCRayN_org_y(rays, n, i) = (ray.origin[1] - center.y) * scale;
  RTCRayN_org_z(rays, n, i) = (ray.origin[2] - center.z) * scale;
  RTCRayN_dir_x(rays, n, i) = ray.direction[0];
  RTCRayN_dir_y(rays, n, i) = ray.direction[1];
  RTCRayN_dir_z(rays, n, i) = ray.direction[2];
  RTCRayN_tnear(rays, n, i) = ray.t_min * scale;
  RTCRayN_tfar(rays, n, i) = ray.t_max * scale;
  RTCRayN_time(rays, n, i) = 0;
  RTCRayN_mask(rays, n, i) = ~0u;
  RTCRayN_flags(rays, n, i) = 0;
}

// The rays of a class N to a struct, traced once.
template <unsigned N, bool any_hit>
class Tracer {
 public:
  using Packed = std::conditional_t<any_hit, typename Packet<N>::AnyRay, typename Packet<N>::ClosestRay>;

  Tracer(const EmbreeScenes& scenes, const std::vector<Ray>& rays)
      : scenes_(scenes), n_rays_(rays.size()), packed_((rays.size() + N - 1) / N) {
    for (std::size_t i = 0; i < packed_.size() * N; ++i) put(i, rays);
    for (unsigned lane = 0; lane < N; ++lane) {
      all_[lane] = -1;
      last_[lane] = (packed_.size() - 1) * N + lane < n_rays_ ? -1 : 0;
    }
  }

  double trace(const Setting& setting, int n_threads) {
    const RTCScene scene = scenes_.get(setting.robust);
    return on_threads(n_threads, packed_.size(), kChunk / N, [&](std::size_t first, std::size_t end) {
      Query query(setting.coherent);
      if constexpr (N == 16)
        if (setting.stream) return trace_streams(query, scene, first, end);
      for (std::size_t p = first; p < end; ++p) query.trace(scene, valid_of(p), &packed_[p]);
    });
  }

  std::vector<Hit> hits() {
    std::vector<Hit> hits(n_rays_);
    for (std::size_t i = 0; i < n_rays_; ++i) hits[i] = hit_of(i);
    return hits;
  }

 private:
  RTCRayN* ray_n(std::size_t packet) { return reinterpret_cast<RTCRayN*>(&packed_[packet]); }

  // Beyond the last ray: an empty interval, which Embree passes over.
  void put(std::size_t i, const std::vector<Ray>& rays) {
    const auto lane = static_cast<unsigned>(i % N);
    Ray ray = rays[std::min(i, rays.size() - 1)];
    if (i >= rays.size()) ray.t_min = kInfinity, ray.t_max = -kInfinity;
    set_ray(ray_n(i / N), N, lane, ray, scenes_.space());
    if constexpr (!any_hit) {
      RTCHitN* const hit = RTCRayHitN_HitN(reinterpret_cast<RTCRayHitN*>(&packed_[i / N]), N);
      RTCHitN_geomID(hit, N, lane) = RTC_INVALID_GEOMETRY_ID;
      RTCHitN_instID(hit, N, lane, 0) = RTC_INVALID_GEOMETRY_ID;
    }
  }

  const int* valid_of(std::size_t packet) const { return (packet + 1) * N <= n_rays_ ? all_ : last_; }

  void trace_streams(Query& query, RTCScene scene, std::size_t first, std::size_t end) {
    if constexpr (N == 16)
      for (std::size_t p = first; p < end; p += kStreamPackets)
        query.stream(scene, &packed_[p],
                     static_cast<unsigned>(std::min<std::size_t>(kStreamPackets, end - p)));
  }

  Hit hit_of(std::size_t i) {
    const auto lane = static_cast<unsigned>(i % N);
    const float t = RTCRayN_tfar(ray_n(i / N), N, lane);
    if constexpr (any_hit) {
      return {t < 0 ? 0 : kInfinity, -1, 0, 0};  // Embree's own mark of an occluded ray
    } else {
      RTCHitN* const hit = RTCRayHitN_HitN(reinterpret_cast<RTCRayHitN*>(&packed_[i / N]), N);
      const unsigned geometry = RTCHitN_geomID(hit, N, lane);
      if (geometry == RTC_INVALID_GEOMETRY_ID) return {kInfinity, -1, 0, 0};
      return {static_cast<float>(scenes_.space().world_length(t)),
              scenes_.number_of(RTCHitN_instID(hit, N, lane, 0), geometry, RTCHitN_primID(hit, N, lane)),
              RTCHitN_u(hit, N, lane), RTCHitN_v(hit, N, lane)};
    }
  }

  const EmbreeScenes& scenes_;
  std::size_t n_rays_;
  std::vector<Packed> packed_;
  alignas(64) int all_[N], last_[N];
};

template <unsigned N>
Traced trace_packets(const EmbreeScenes& scenes, const RayClass& c, const Setting& setting, int threads) {
  const auto run = [&](auto&& tracer) {
    const double seconds = tracer.trace(setting, threads);
    return Traced{seconds, tracer.hits()};
  };
  if (c.rays.empty()) return {};
  return c.any_hit ? run(Tracer<N, true>(scenes, c.rays)) : run(Tracer<N, false>(scenes, c.rays));
}

using TraceFunction = Traced (*)(const EmbreeScenes&, const RayClass&, const Setting&, int);

struct Mode {
  const char* name;
  TraceFunction trace;
  bool stream;
};

constexpr Mode kModes[] = {{"1", trace_packets<1>, false},
                           {"8", trace_packets<8>, false},
                           {"16", trace_packets<16>, false},
                           {"stream", trace_packets<16>, true}};

Contestant contestant(const std::shared_ptr<EmbreeScenes>& scenes, const Mode& mode, bool robust,
                      int threads) {
  Contestant made{robust ? Family::embree_robust : Family::embree_fast, mode.name, {}};
  for (const bool coherent : {true, false})
    made.variants.push_back({coherent ? "coherent" : "incoherent",
                             [=, setting = Setting{robust, coherent, mode.stream}](const RayClass& c) {
                               return mode.trace(*scenes, c, setting, threads);
                             }});
  return made;
}

}  // namespace

std::string embree_version() {
  return RTC_VERSION_STRING;
}

std::shared_ptr<EmbreeScenes> make_embree_scenes(const scene::Scene& scene) {
  return std::make_shared<EmbreeScenes>(scene);
}

std::vector<Contestant> embree_contestants(const std::shared_ptr<EmbreeScenes>& scenes, int threads) {
  std::vector<Contestant> contestants;
  for (const bool robust : {false, true})
    for (const Mode& mode : kModes)
      if (kHasStreams || !mode.stream) contestants.push_back(contestant(scenes, mode, robust, threads));
  return contestants;
}

Traced trace_embree16(const std::shared_ptr<EmbreeScenes>& scenes, const RayClass& rays, int threads) {
  return trace_packets<16>(*scenes, rays, {.robust = false, .coherent = true, .stream = false}, threads);
}

}  // namespace kdray::bench
