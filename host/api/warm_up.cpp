// What    Programs made before they are wanted: for each of the forms of trees that nearly all scenes have,
//         those of frames and of queries, with all that a scene may need.
// Shape   A small scene is brought into blocks of that form, and each program is launched on it once, since
//         drivers compile the last of it then.
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "accel/flatten/frame.h"
#include "accel/kdtree/build.h"
#include "accel/prepare/prepared.h"
#include "api/open_devices.h"
#include "api/precision.h"
#include "base/timer.h"
#include "device/opencl/program_cache.h"
#include "engine/query/trace.h"
#include "engine/wavefront/channels.h"
#include "engine/wavefront/wavefront.h"
#include "probe/selftest/self_test.h"
#include "scene/model/geometry.h"

namespace kdray::api {

namespace {

constexpr int kSide = 16;  // pixels

// The self-test's scene, in blocks of that many primitives.
prepare::Prepared scene_in_blocks(int block) {
  const scene::Scene known = selftest::known_scene();
  prepare::Prepared made = prepare::prepare(known, TreeOptions{});
  const scene::Geometry geometry = scene::make_geometry(known);
  const kdtree::Tree tree =
      kdtree::build(geometry, prepare::config_of(TreeOptions{}, made.counts.primitives));
  made.wide = flatten::make_wide(tree, made.flat, block);
  return made;
}

// A device's programs for trees of a form.
class Warming {
 public:
  Warming(const device::Context& context, const DeviceOptions& options, const prepare::Prepared& scene,
          const wavefront::TreeForm& form, const Tuning& tuning)
      : context_(context),
        scene_(scene),
        work_group_(engine::work_group_of(options, context)),
        global_(engine::runs_globally(options, context)),
        buffers_(context, scene.flat, scene.wide),
        programs_(context, form) {
    programs_.use(tuning);
    programs_.query_alone(global_);
    programs_.have_everything();
  }

  // Of lights with an area, as a studio has them: rays have another form then.
  void soft_frames() { frames_of(scene_.features | KDRAY_FEATURE_AREA_LIGHTS); }
  void frames() { frames_of(scene_.features); }
  void queries() {
    const Ray ray{{0, 0, 0}, 0, {0, 0, -1}, 1};
    const query::Target target{context_, buffers_, programs_, scene_, work_group_, global_};
    (void)query::trace(target, std::span(&ray, 1), {});
  }

  bool compiled() const { return programs_.used().compiled > 0; }

 private:
  // A Wavefront launches its kernels as it is made.
  void frames_of(layout::Features features) {
    const RenderOptions o = flatten::resolved({.width = kSide, .height = kSide}, {});
    layout::Frame frame = flatten::make_frame(scene_.settings, scene_.geometry, o);
    wavefront::Schedule schedule{.tile_width = kSide, .tile_height = kSide, .n_slices = 1, .fused = !global_};
    schedule.work_group = work_group_;
    schedule.traversal = traversal_in(Precision::float32, Traversal::automatic, context_.info());
    schedule.apply(frame, features);
    const wavefront::Capacity capacity{.tiles = 1, .pixels = std::size_t{kSide} * kSide};
    const wavefront::Wavefront wavefront(context_, context_.queues().front(), buffers_, programs_, frame,
                                         schedule, features, capacity);
  }

  const device::Context& context_;
  const prepare::Prepared& scene_;
  std::size_t work_group_;
  bool global_;
  const wavefront::SceneBuffers buffers_;
  wavefront::Programs programs_;
};

[[noreturn]] void report_unkept(const std::filesystem::path& folder) {
  throw input_error(folder.string(), 0, "no program can be kept there",
                    "free some space, or name another folder (--cache, KDRAY_CACHE_DIR)");
}

// Before anything is compiled for nothing.
void check(const std::filesystem::path& folder) {
  if (folder.empty())
    throw Error(ErrorCode::usage, "there is no folder to keep programs in; name one with --cache");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder, error)) report_unkept(folder);
}

// Writes what was compiled, so that nothing of it is lost where what follows is broken off.
void keep(const DeviceOptions& options, device::ProgramCache& cache) {
  if (cache.keep() == 0) report_unkept(options.programs);
}

}  // namespace

}  // namespace kdray::api

namespace kdray {

std::vector<WarmProgram> warm_up(const DeviceOptions& options,
                                 const std::function<void(const WarmProgram&)>& told, std::uint64_t largest) {
  using namespace api;
  check(options.programs);
  const OpenedDevices opened = open_devices(options);
  const tuning::Database tunings = read_tunings(options);
  device::ProgramCache& cache = *builds_of(options).cache;
  cache.keep();  // what the opening has compiled
  std::vector<WarmProgram> all;
  for (const device::Context& context : opened.contexts)
    for (const auto& [form, scenes] : wavefront::Programs::usual_forms()) {
      if (form.bytes > largest) continue;
      const prepare::Prepared scene = scene_in_blocks(form.block);
      const Tuning tuning = tuned_for(context, engine::runs_globally(options, context), scene.features,
                                      tunings, options.tunings.string())
                                .settings;
      const auto make = [&, &form = form, &scenes = scenes](const std::string& work,
                                                            void (Warming::*launch)()) {
        const Timer timer;
        Warming warming(context, options, scene, form, tuning);
        (warming.*launch)();
        if (warming.compiled()) keep(options, cache);
        all.push_back({context.info().name, work + " of " + scenes, timer.seconds(), warming.compiled()});
        if (told) told(all.back());
      };
      make("frames", &Warming::frames);
      make("frames in soft light", &Warming::soft_frames);
      make("queries", &Warming::queries);
    }
  return all;
}

}  // namespace kdray
