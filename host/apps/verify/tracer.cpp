#include "apps/verify/tracer.h"

#include "api/open_devices.h"
#include "device/opencl/opencl_error.h"
#include "engine/query/trace.h"
#include "engine/wavefront/stage.h"
#include "layout/rays.layout.h"
#include "layout/tree.layout.h"

namespace kdray::verify {

namespace {

constexpr std::size_t kWorkGroup = 16;

DeviceOptions one_queue(DeviceOptions options) {
  options.queues = 1;
  return options;
}

template <class Primitive>
void name_refs(const Array<Primitive>& primitives, std::uint32_t kind, std::vector<std::uint32_t>& ref_of) {
  for (std::size_t i = 0; i < primitives.size(); ++i)
    ref_of[primitives[i].number] = kind << KDRAY_REF_KIND_SHIFT | static_cast<std::uint32_t>(i);
}

}  // namespace

prepare::Prepared in_local_space(prepare::Prepared prepared) {
  if (auto& camera = prepared.settings.camera) {
    const LocalSpace& space = prepared.geometry.space;
    camera->from = space.local(camera->from);
    camera->at = space.local(camera->at);
    camera->hither = space.local_length(camera->hither);
  }
  prepared.geometry.space = {};
  return prepared;
}

Tracer::Tracer(const prepare::Prepared& scene, const DeviceOptions& device)
    : scene_(scene),
      context_(api::open_devices(one_queue(device)).contexts.front()),
      buffers_(context_, scene.flat, scene.wide),
      programs_(context_, scene.tree_depth, scene.wide),
      ref_of_(scene.counts.primitives, KDRAY_REF_MISS) {
  primitives::for_each_kind(
      [&](auto kind) { name_refs(decltype(kind)::of(scene.flat), kind.kNumber, ref_of_); });
}

std::vector<Hit> Tracer::closest(std::span<const Ray> rays, Traversal wanted) {
  // Packets and batches are explicit vectors, for CPUs.
  const bool vectors = context_.info().kind == "cpu";
  const Traversal traversal = !vectors && wanted != Traversal::binary ? Traversal::wide : wanted;
  query::Target target{context_, buffers_, programs_, scene_, kWorkGroup};
  target.traversal = traversal;
  return query::trace(target, rays, {}).hits;
}

std::vector<layout::Departure> Tracer::departures(std::span<const Ray> rays, std::span<const Hit> hits) {
  std::vector<layout::Departure> departures(rays.size());
  if (rays.empty()) return departures;
  std::vector<layout::KnownHit> known(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i)
    known[i] = {hits[i].t, ref_of_[static_cast<std::size_t>(hits[i].primitive)], hits[i].u, hits[i].v};
  using K = kernels::Depart;
  wavefront::Stage stage(programs_.kernel<K>(scene_.features));
  device::checked("finding where rays leave", [&] {
    const cl::Buffer in_rays = context_.upload_copy(rays.data(), rays.size_bytes(), "the rays");
    const cl::Buffer in_hits = context_.upload_copy(known.data(), known.size() * sizeof known[0], "the hits");
    const std::size_t bytes = departures.size() * sizeof departures[0];
    const cl::Buffer out = context_.buffer(CL_MEM_WRITE_ONLY, bytes, "the rays' origins");
    cl::CommandQueue queue = context_.queues().front();
    buffers_.set_arguments(stage);
    stage.set(K::n_rays, static_cast<cl_uint>(rays.size()));
    stage.set(K::rays, in_rays).set(K::hits, in_hits).set(K::departures, out);
    stage.launch(queue, (rays.size() + KDRAY_LANES - 1) / KDRAY_LANES, 1);
    queue.enqueueReadBuffer(out, CL_TRUE, 0, bytes, departures.data());
  });
  return departures;
}

}  // namespace kdray::verify
