#include "engine/query/trace.h"

#include <algorithm>

#include "base/timer.h"
#include "device/opencl/opencl_error.h"
#include "engine/query/check_rays.h"
#include "engine/query/near_rays.h"
#include "engine/query/scene_arguments.h"
#include "engine/query/session.h"
#include "engine/query/surface.h"
#include "engine/wavefront/stage.h"
#include "layout/rays.layout.h"
#include "layout/traversal.h"

namespace kdray::query {

namespace {

static_assert(sizeof(Ray) == sizeof(layout::QueryRay) && sizeof(Hit) == sizeof(layout::QueryHit));

// Rays in one launch: 512 MiB of them; and for a GPU, whose watchdog may end what takes seconds.
constexpr std::size_t kRaysPerChunk = std::size_t{1} << 24, kBoundedLaunch = std::size_t{1} << 20;

// PoCL compiles a kernel for good at its first launch: here one of as many work-items that finds no rays, not
// in the time of tracing.
template <class Launch>
void warm_up(const device::Context& context, wavefront::Stage<kernels::TraceQuery>& stage,
             const Launch& launch) {
  const device::AtWork compiling(context.builds());
  stage.set(kernels::TraceQuery::n_rays, cl_uint{0});
  launch();
}

}  // namespace

Traced trace(const Target& target, std::span<const Ray> rays, const TraceOptions& options) {
  const device::Context& context = target.context;
  check_rays(rays);
  const bool placed = !target.scene.flat.instances.empty();
  Traced result{std::vector<Hit>(rays.size()), std::vector<std::uint32_t>(placed ? rays.size() : 0),
                std::vector<double>(static_cast<std::size_t>(std::max(options.repeat, 1)))};
  if (rays.empty()) return result;
  const std::size_t chunk = std::min({rays.size(), target.global ? kBoundedLaunch : kRaysPerChunk,
                                      static_cast<std::size_t>(context.info().max_allocation / sizeof(Ray))});
  const cl::Buffer ray_buffer = context.buffer(CL_MEM_READ_ONLY, chunk * sizeof(Ray), "the rays");
  const cl::Buffer hit_buffer = context.buffer(CL_MEM_WRITE_ONLY, chunk * sizeof(Hit), "the hits");
  const cl::Buffer instance_buffer =
      context.buffer(CL_MEM_WRITE_ONLY, (placed ? chunk : 1) * sizeof(cl_uint), "the hits' instances");
  using K = kernels::TraceQuery;
  const Traversal traversal = options.traversal;
  wavefront::Stage stage(target.programs.kernel<K>(target.scene.features, traversal, options.precision));
  const bool chunked = traversal != Traversal::binary && traversal != Traversal::wide;
  cl::CommandQueue queue = context.queues().front();
  NearRays near_rays(target.scene.geometry.space);
  const LocalSpace& space = near_rays.kernel_space();
  device::checked("tracing rays", [&] {
    set_scene_arguments(stage, target);
    stage.set(K::space, float4(space));
    stage.set(K::any_hit, cl_uint{options.any_hit}).set(K::rays, ray_buffer).set(K::hits, hit_buffer);
    stage.set(K::hit_instances, instance_buffer);
    // Rays of the command line have no masks: what is bound for them is not read.
    stage.set(K::as_refs, cl_uint{0}).set(K::primitive_masks, hit_buffer).set(K::ray_masks, hit_buffer);
    stage.set(K::any_length, cl_uint{!std::all_of(rays.begin(), rays.end(), is_ordinary)});
    for (std::size_t first = 0; first < rays.size(); first += chunk) {
      const std::size_t n = std::min(chunk, rays.size() - first);
      const std::span<const Ray> taken = near_rays.take(rays.subspan(first, n));
      queue.enqueueWriteBuffer(ray_buffer, CL_TRUE, 0, n * sizeof(Ray), taken.data());
      // Memory that nobody has written to yet is handed out page by page, which is no part of tracing.
      queue.enqueueFillBuffer(hit_buffer, cl_int{0}, 0, n * sizeof(Hit));
      queue.finish();
      const auto launch = [&] {
        chunked ? stage.launch(queue, (n + KDRAY_CHUNK - 1) / KDRAY_CHUNK, 1)
                : stage.launch(queue, n, target.work_group);
        queue.finish();
      };
      if (first == 0) warm_up(context, stage, launch);
      stage.set(K::n_rays, static_cast<cl_uint>(n));
      for (double& seconds : result.seconds) {
        const Timer timer;
        launch();
        seconds += timer.seconds();
      }
      queue.enqueueReadBuffer(hit_buffer, CL_TRUE, 0, n * sizeof(Hit), result.hits.data() + first);
      if (placed)
        queue.enqueueReadBuffer(instance_buffer, CL_TRUE, 0, n * sizeof(cl_uint),
                                result.instances.data() + first);
      near_rays.give_back(std::span(result.hits).subspan(first, n));
    }
  });
  if (std::any_of(result.hits.begin(), result.hits.end(),
                  [](const Hit& h) { return h.primitive == kFailedWalk; }))
    throw Error(ErrorCode::internal,
                "a ray overflowed the traversal's stack; please report it with the scene");
  name_places(target.scene.flat, result.instances);
  return result;
}

}  // namespace kdray::query
