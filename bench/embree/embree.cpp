#include "bench/embree/embree.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <latch>
#include <thread>

#include "base/timer.h"
#include "bench/embree/packets.h"
#include "bench/embree/scenes.h"
#include "bench/embree/workers.h"

namespace kdray::bench::embree {

namespace {

constexpr std::size_t kChunk = 4096;  // rays that a thread draws at a time

struct Setting {
  bool robust, coherent, stream;
};

// Runs `trace_chunk(first, end)` over [0, n) on threads that wait for the clock to start. Seconds.
template <class TraceChunk>
double on_threads(int n_threads, std::size_t n, std::size_t chunk, const TraceChunk& trace_chunk) {
  std::atomic<std::size_t> next{0};
  std::latch ready(n_threads), start(1);
  std::vector<std::thread> threads;
  for (int i = 0; i < n_threads; ++i)
    threads.emplace_back([&] {
      const FlushedDenormals flush;
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

// The rays of a class N to a struct, traced once.
template <unsigned N, bool any_hit>
class Tracer {
 public:
  Tracer(const Scenes& scenes, const std::vector<Ray>& rays)
      : scenes_(scenes), n_rays_(rays.size()), packed_((rays.size() + N - 1) / N) {
    for (std::size_t i = 0; i < packed_.size() * N; ++i) put(i, rays);
    for (unsigned lane = 0; lane < N; ++lane) {
      all_[lane] = -1;
      last_[lane] = (packed_.size() - 1) * N + lane < n_rays_ ? -1 : 0;
    }
  }

  double trace(const Setting& setting, int n_threads) {
    const Scene scene = scenes_.get(setting.robust);
    return on_threads(n_threads, packed_.size(), kChunk / N, [&](std::size_t first, std::size_t end) {
      Query query(scenes_.library(), setting.coherent);
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
  // Beyond the last ray: an empty interval, which Embree passes over.
  void put(std::size_t i, const std::vector<Ray>& rays) {
    const auto lane = static_cast<unsigned>(i % N);
    Ray ray = rays[std::min(i, rays.size() - 1)];
    if (i >= rays.size()) ray.t_min = kInfinity, ray.t_max = -kInfinity;
    const vec3 center(scenes_.space().center);
    const auto scale = static_cast<float>(scenes_.space().scale);
    float origin[3];
    for (int k = 0; k < 3; ++k) origin[k] = (ray.origin[k] - center[k]) * scale;
    put_ray(rays_of(packed_[i / N]), lane, origin, ray.direction, ray.t_min * scale, ray.t_max * scale);
    put_no_hit(packed_[i / N], lane);
  }

  const int* valid_of(std::size_t packet) const { return (packet + 1) * N <= n_rays_ ? all_ : last_; }

  void trace_streams(Query& query, Scene scene, std::size_t first, std::size_t end) {
    if constexpr (N == 16)
      for (std::size_t p = first; p < end; p += kStreamPackets)
        query.stream(scene, &packed_[p],
                     static_cast<unsigned>(std::min<std::size_t>(kStreamPackets, end - p)));
  }

  Hit hit_of(std::size_t i) {
    const auto lane = static_cast<unsigned>(i % N);
    const float t = rays_of(packed_[i / N]).t_far[lane];
    if constexpr (any_hit) {
      return {t < 0 ? 0 : kInfinity, -1, 0, 0};  // Embree's own mark of an occluded ray
    } else {
      const Hits<N>& hit = packed_[i / N].hit;
      if (hit.geometry[lane] == kNone) return {kInfinity, -1, 0, 0};
      return {static_cast<float>(scenes_.space().world_length(t)),
              scenes_.number_of(hit.instance[lane], hit.geometry[lane], hit.primitive[lane]), hit.u[lane],
              hit.v[lane]};
    }
  }

  const Scenes& scenes_;
  std::size_t n_rays_;
  std::vector<Packed<N, any_hit>> packed_;
  alignas(64) int all_[N], last_[N];
};

template <unsigned N>
Traced trace_packets(const Scenes& scenes, const RayClass& c, const Setting& setting, int threads) {
  const auto run = [&](auto&& tracer) {
    const double seconds = tracer.trace(setting, threads);
    return Traced{seconds, tracer.hits()};
  };
  if (c.rays.empty()) return {};
  return c.any_hit ? run(Tracer<N, true>(scenes, c.rays)) : run(Tracer<N, false>(scenes, c.rays));
}

using TraceFunction = Traced (*)(const Scenes&, const RayClass&, const Setting&, int);

struct Mode {
  const char* name;
  TraceFunction trace;
  bool stream;
};

constexpr Mode kModes[] = {{"1", trace_packets<1>, false},
                           {"8", trace_packets<8>, false},
                           {"16", trace_packets<16>, false},
                           {"stream", trace_packets<16>, true}};

Contestant contestant(const std::shared_ptr<Scenes>& scenes, const Mode& mode, bool robust, int threads) {
  Contestant made{robust ? Family::embree_robust : Family::embree_fast,
                  fmt::format("{}:{}", scenes->library().major, mode.name),
                  {}};
  for (const bool coherent : {true, false})
    made.variants.push_back({coherent ? "coherent" : "incoherent",
                             [=, setting = Setting{robust, coherent, mode.stream}](const RayClass& c) {
                               return mode.trace(*scenes, c, setting, threads);
                             }});
  return made;
}

}  // namespace

}  // namespace kdray::bench::embree

namespace kdray::bench {

std::string embree_versions() {
  std::string versions;
  for (const embree::Library& library : embree::libraries())
    versions += (versions.empty() ? "" : " and ") + library.version;
  return versions;
}

Json embree_json(bool is_wanted) {
  const std::string versions = is_wanted ? embree_versions() : "";
  return versions.empty() ? Json() : Json(versions);
}

EmbreeScenes make_embree_scenes(const scene::Scene& scene) {
  EmbreeScenes all;
  for (const embree::Library& library : embree::libraries())
    all.push_back(std::make_shared<embree::Scenes>(library, scene));
  return all;
}

std::vector<Contestant> embree_contestants(const EmbreeScenes& all, int threads) {
  std::vector<Contestant> contestants;
  for (const bool robust : {false, true})
    for (const auto& scenes : all)
      for (const embree::Mode& mode : embree::kModes)
        if (scenes->library().major == 3 || !mode.stream)
          contestants.push_back(embree::contestant(scenes, mode, robust, threads));
  return contestants;
}

}  // namespace kdray::bench
