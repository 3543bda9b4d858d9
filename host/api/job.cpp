#include "api/job.h"

#include "accel/flatten/features.h"
#include "accel/flatten/frame.h"
#include "api/precision.h"
#include "api/state.h"
#include "layout/features.h"
#include "scene/model/added_geometry.h"
#include "scene/model/frame.h"

namespace kdray::api {

namespace {

// The box that tells of rays that nothing can be in the way of them. Nobody asks where no light and no
// further ray is traced, or where such rays are to be traced all the same.
void use_core(State& state, Job& job) {
  constexpr layout::Features kTraces = KDRAY_FEATURE_LIGHTS | KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT;
  if (!(job.features & kTraces) || job.frame.keep_weightless) return;
  if (!state.core) state.core = flatten::core_of(state.scene.flat);
  // Without faces the frame's core stays empty: a program with faces then asks about none.
  if (!state.core->has_faces) return;
  state.core->apply(job.frame, state.scene.flat.lights);
  job.features |= KDRAY_FEATURE_FACES;
}

}  // namespace

namespace {

// Between launches the calling thread looks whether the picture is still wanted.
std::function<void(double)> progress_of(const RenderOptions& o) {
  if (!o.cancel) return o.progress;
  return [progress = o.progress, cancel = *o.cancel](double share) {
    if (cancel.is_cancelled()) throw Error(ErrorCode::cancelled, "the picture was cancelled");
    if (progress) progress(share);
  };
}

layout::Frame frame_of(const prepare::Prepared& scene, const RenderOptions& o) {
  if (!o.camera) return flatten::make_frame(scene.settings, scene.geometry, o);
  scene::Scene seen = scene.settings;
  seen.camera = scene::camera_of(*o.camera);
  return flatten::make_frame(seen, scene.geometry, o);
}

}  // namespace

Job make_job(State& state, const RenderOptions& options, timeline::Timeline* timeline) {
  const prepare::Prepared& scene = state.scene;
  // Another camera than the scene's has no aspect ratio.
  RenderOptions o = flatten::resolved(
      options, options.camera ? scene.settings.settings : scene::settings_of(scene.settings));
  o.progress = progress_of(o);
  check_division(o);
  check_channels(o, scene);
  const layout::Features features =
      state.devices.features() | flatten::features_of_samples(o.samples, o.adaptive_target > 0) | state.keep;
  Job job{o, frame_of(scene, o), features, timeline};
  use_core(state, job);
  return job;
}

frame::Request request_of(State& state, const Job& job) {
  return {.frame = job.frame,
          .features = job.features,
          .adaptive_target = job.options.adaptive_target,
          .progress = job.options.progress,
          .fault_injector = &state.fault_injector,
          .timeline = job.timeline,
          .checkpoint = job.checkpoint.get()};
}

}  // namespace kdray::api
