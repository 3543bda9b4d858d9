#include "engine/query/trace.h"

#include <algorithm>
#include <atomic>
#include <deque>

#include "base/error.h"
#include "base/timer.h"
#include "device/opencl/opencl_error.h"
#include "engine/query/check_rays.h"
#include "engine/query/grains.h"
#include "engine/query/local_rays.h"
#include "engine/query/scene_arguments.h"
#include "engine/query/surface.h"
#include "layout/features.h"
#include "layout/traversal.h"

namespace kdray::query {

namespace {

layout::Features features_to_trace(const Target& target) {
  return target.scene.features | (target.masks() != nullptr ? KDRAY_FEATURE_MASKS : 0) |
         (target.filters ? KDRAY_FEATURE_FILTER : 0);
}

}  // namespace

void throw_failed_walk() {
  throw Error(ErrorCode::internal,
              "a ray met a primitive of a kind that its kernel lacks; please report it with the scene");
}

std::size_t Session::usual_chunk(const Target& target) {
  constexpr std::size_t kChunk = std::size_t{1} << 16, kGlobalChunk = std::size_t{1} << 20;
  return target.global ? kGlobalChunk : kChunk;
}

Session::Session(const Target& target, std::size_t chunk)
    : masked_(target.masks() != nullptr),
      placed_(!target.scene.flat.instances.empty()),
      queue_(target.context, target.sub_device),
      stage_(target.programs.kernel<kernels::TraceQuery>(features_to_trace(target), target.walk(),
                                                         target.precision)),
      work_group_(target.work_group),
      chunked_(target.walk() != Traversal::binary && target.walk() != Traversal::wide) {
  using K = kernels::TraceQuery;
  device::checked("getting ready to trace rays", [&] {
    rays_ = {target.context, CL_MEM_READ_ONLY, chunk, "the rays"};
    hits_ = {target.context, CL_MEM_WRITE_ONLY, chunk, "the hits"};
    masks_ = {target.context, CL_MEM_READ_ONLY, masked_ ? chunk : 1, "the rays' masks"};
    instances_ = {target.context, CL_MEM_WRITE_ONLY, placed_ ? chunk : 1, "the hits' instances"};
    set_scene_arguments(stage_, target);
    if (target.programs.walks_alone(K::kFile, target.walk()))
      stage_.set(K::wide_nodes, target.buffers.compressed_nodes());
    stage_.set(K::space, float4(vec3(0), 1)).set(K::any_length, cl_uint{0});
    stage_.set(K::rays, rays_.buffer()).set(K::hits, hits_.buffer());
    stage_.set(K::hit_instances, instances_.buffer());
    stage_.set(K::primitive_masks, masked_ ? target.masks : masks_.buffer());
    stage_.set(K::ray_masks, masks_.buffer());
    stage_.set(K::any_hit, cl_uint{0}).set(K::as_refs, cl_uint{0});
  });
  const device::AtWork compiling(target.context.builds());
  warm_up(1);
}

void Session::warm_up(std::size_t n) {
  std::fill_n(hits_.data(), n, layout::QueryHit{});
  device::checked("getting ready to trace rays", [&] { enqueue(0, n); });
  finish();
}

bool Session::settle() noexcept {
  return !started_ || clFinish(queue_.get()()) == CL_SUCCESS;
}

void Session::enqueue(std::size_t n, std::size_t n_items) {
  using K = kernels::TraceQuery;
  stage_.set(K::n_rays, static_cast<cl_uint>(n));
  chunked_ ? stage_.launch(queue_.get(), (n_items + KDRAY_CHUNK - 1) / KDRAY_CHUNK, 1)
           : stage_.launch(queue_.get(), n_items, work_group_);
}

void Session::load(std::size_t n, bool any_hit, bool as_refs) {
  using K = kernels::TraceQuery;
  started_ = true;
  n_started_ = n;
  device::checked("tracing rays", [&] {
    stage_.set(K::any_hit, cl_uint{any_hit}).set(K::as_refs, cl_uint{as_refs});
    rays_.send(queue_.get(), n);
    if (masked_) masks_.send(queue_.get(), n);
  });
}

void Session::launch() {
  device::checked("tracing rays", [&] {
    enqueue(n_started_, n_started_);
    queue_.get().flush();
  });
}

void Session::finish() {
  device::checked("tracing rays", [&] {
    queue_.get().finish();
    stage_.forget_launches();
  });
}

std::span<const layout::QueryHit> Session::wait() {
  finish();
  device::checked("tracing rays", [&] {
    hits_.fetch(queue_.get(), n_started_);
    if (placed_) instances_.fetch(queue_.get(), n_started_);
  });
  started_ = false;
  return hits_.first(n_started_);
}

namespace {

static_assert(sizeof(Hit) == sizeof(layout::QueryHit));

// Rays in one launch: 512 MiB of them; and for a GPU, whose watchdog may end what takes seconds.
constexpr std::size_t kRaysPerLaunch = std::size_t{1} << 24, kBoundedLaunch = std::size_t{1} << 20;

Rays rays_of(std::span<const Ray> rays) {
  const std::size_t n = rays.size();
  const Ray& first = rays.front();
  return {.origins = {first.origin, n, sizeof(Ray)},
          .directions = {first.direction, n, sizeof(Ray)},
          .t_min = {&first.t_min, n, sizeof(Ray)},
          .t_max = {&first.t_max, n, sizeof(Ray)}};
}

double units_of(const Target& target) {
  return static_cast<double>(target.context.info().compute_units) /
         static_cast<double>(target.context.n_sub_devices());
}

// The rays that a target traces at a time, of so many in all: `share` of them, as far as they fit.
std::size_t chunk_of(const Target& target, std::size_t n_rays, double share) {
  const std::size_t fair = static_cast<std::size_t>(static_cast<double>(n_rays) * share) + 1;
  return std::min({fair, n_rays, target.global ? kBoundedLaunch : kRaysPerLaunch,
                   static_cast<std::size_t>(target.context.info().max_allocation / sizeof(Ray))});
}

// A target at work on its part of a round.
class Part {
 public:
  Part(const Target& target, const RayArrays& rays, const LocalFrame& frame, std::size_t chunk)
      : session_(target, chunk), local_(rays, frame) {
    session_.warm_up(chunk);
  }

  // Takes rays from `first` on: returns where the rest begins.
  std::size_t load(std::size_t first, std::size_t n_rays, bool any_hit) {
    first_ = first;
    any_hit_ = any_hit;
    const std::size_t n = std::min(session_.chunk(), n_rays - first);
    local_.fill(first, n, session_.rays());
    session_.load(n, any_hit, false);
    session_.finish();
    return first + n;
  }
  void launch() { session_.launch(); }
  void finish() { session_.finish(); }

  void take(Traced& traced) {
    const std::span<const layout::QueryHit> hits = session_.wait();
    std::atomic<bool> failed{false};
    for_each_index(hits.size(), [&](std::size_t i) {
      const layout::QueryHit& hit = hits[i];
      if (hit.primitive == kFailedWalk) failed = true;
      // What was hit at all has t = 0.
      const float t = any_hit_ ? hit.t : static_cast<float>(local_.world_t(i, hit.t));
      traced.hits[first_ + i] = {t, hit.primitive, hit.u, hit.v};
    });
    if (failed) throw_failed_walk();
    std::ranges::copy(session_.instances(), traced.instances.begin() + static_cast<std::ptrdiff_t>(first_));
  }

 private:
  Session session_;
  LocalRays local_;
  std::size_t first_ = 0;
  bool any_hit_ = false;
};

void trace_round(std::span<Part* const> parts, std::vector<double>& seconds) {
  for (double& s : seconds) {
    const Timer timer;
    for (Part* const part : parts) part->launch();
    for (Part* const part : parts) part->finish();
    s += timer.seconds();
  }
}

}  // namespace

Traced trace(std::span<const Target> targets, std::span<const Ray> rays, const TraceOptions& options) {
  check_rays(rays);
  const prepare::Prepared& scene = targets.front().scene;
  const bool placed = !scene.flat.instances.empty();
  Traced traced{std::vector<Hit>(rays.size()), std::vector<std::uint32_t>(placed ? rays.size() : 0),
                std::vector<double>(static_cast<std::size_t>(std::max(options.repeat, 1)))};
  if (rays.empty()) return traced;
  const RayArrays arrays(rays_of(rays));
  const LocalFrame frame(scene.geometry);
  double units = 0;
  for (const Target& target : targets) units += units_of(target);
  std::deque<Part> parts;
  for (const Target& target : targets)
    parts.emplace_back(target, arrays, frame, chunk_of(target, rays.size(), units_of(target) / units));
  for (std::size_t first = 0; first < rays.size();) {
    std::vector<Part*> at_work;
    for (auto part = parts.begin(); part != parts.end() && first < rays.size(); ++part) {
      first = part->load(first, rays.size(), options.any_hit);
      at_work.push_back(&*part);
    }
    trace_round(at_work, traced.seconds);
    for (Part* const part : at_work) part->take(traced);
  }
  name_places(scene.flat, traced.instances);
  return traced;
}

Traced trace(const Target& target, std::span<const Ray> rays, const TraceOptions& options) {
  return trace(std::span(&target, 1), rays, options);
}

}  // namespace kdray::query
