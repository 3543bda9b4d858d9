#include "api/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "accel/flatten/features.h"
#include "accel/flatten/frame.h"
#include "accel/flatten/scene_hash.h"
#include "api/choose_mode.h"
#include "api/precision.h"
#include "api/record.h"
#include "api/state.h"
#include "base/hash.h"
#include "checkpoint_fingerprint.h"
#include "device/opencl/program.h"
#include "engine/pdprt/tiles.h"
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
  // Without faces, or a floor around the core, the frame's core stays empty: a program that has code for them
  // then asks about none.
  const bool has_floor = job.frame.floor_radius > 0 && state.core->is_known;
  if (!state.core->has_faces && !has_floor) return;
  state.core->apply(job.frame, state.scene.flat.lights);
  job.features |= KDRAY_FEATURE_FACES;
}

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
  if (job.frame.lens_radius > 0) job.features |= KDRAY_FEATURE_LENS;  // the scene's own camera may have none
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

namespace {

// All of the frame that has a say in its film; what is left out is about how it is divided, or about what
// need not be done.
std::string settings_in_full(const Job& job) {
  const layout::Frame& f = job.frame;
  std::string text;
  const auto add = [&text](const auto& values) { text += fmt::format("{:a} ", fmt::join(values, " ")); };
  add(f.eye), add(f.forward), add(f.right), add(f.up), add(f.background);
  add(std::array{f.hither, f.x_scale, f.x_offset, f.y_scale, f.y_offset, f.spawn_threshold});
  add(std::array{f.lens_radius, f.lens_slope});
  text +=
      fmt::format("{} {} {} {} {} {} {} {:a} {}", f.width, f.height, f.n_samples, f.max_depth, f.corner_grid,
                  f.keep_weightless, f.parallel, job.options.adaptive_target, name_of(job.options.precision));
  if (job.options.crop) text += fmt::format(" {} {} {}", f.crop_x, f.crop_y, f.whole_width);
  return text;
}

std::string settings_in_words(const Job& job) {
  const layout::Frame& f = job.frame;
  const double target = job.options.adaptive_target;
  const std::string samples =
      target > 0 ? fmt::format("adaptive:{:.4g}", target) : std::to_string(f.n_samples);
  const auto& crop = job.options.crop;
  return fmt::format("--size {}x{}{} --samples {} --depth {} --min-weight {:.4g}{}{}", job.options.width,
                     job.options.height, crop ? " --crop " + flatten::in_words(*crop) : "", samples,
                     f.max_depth, job.options.min_weight,
                     job.options.precision == Precision::float64 ? " --precision double" : "",
                     f.corner_grid != 0 ? " --grid corners" : "");
}

// Drivers compute sines and powers as they like, so that a checkpoint keeps to one. Devices of one driver are
// let be: most give the same bits, and where they don't, tiles that were made twice tell.
std::string build_in_words(const State& state) {
  const DeviceInfo& info = state.devices.first().context.info();
  return fmt::format("kdray {} with {}, {}", KDRAY_VERSION, info.version, info.driver);
}

std::string build_in_full(const State& state) {
  const Hash kernels =
      hash_of(device::expand_source("wave/wave.cl") + device::expand_source("traverse/trace_closest.cl"));
  return fmt::format("{}, code {}, kernels {}", build_in_words(state), KDRAY_FINGERPRINT, in_hex(kernels));
}

std::string makers(const State& state) {
  std::vector<std::string> names;
  for (const Device& d : state.devices) names.push_back(d.context.info().name);
  return fmt::format("{}", fmt::join(names, " and "));
}

// The same for every machine, however many queues it has: small enough that many can share a picture, and
// that the last ones of an interval keep nobody waiting for long; as large where a tile has few samples as
// rays like it.
checkpoint::Cut cut_of(const Job& job) {
  const layout::Frame& f = job.frame;
  constexpr std::uint32_t kUnits = 4;
  // A tile of thousands of samples would take longer than an interval.
  std::uint32_t largest = f.n_samples >= 16 ? 8 : f.n_samples >= 4 ? 16 : pdprt::kLargestTile;
  if (f.n_samples >= 1024) largest = f.n_samples >= 4096 ? 2 : 4;
  const std::uint32_t side = pdprt::choose_tile_side(f.width, f.height, kUnits, {}, largest);
  const RenderOptions& o = job.options;
  return {f.width, f.height, o.tile_width > 0 ? static_cast<std::uint32_t>(o.tile_width) : side,
          o.tile_height > 0 ? static_cast<std::uint32_t>(o.tile_height) : side};
}

}  // namespace

checkpoint::Identity identity_of(State& state, const Job& job) {
  const flatten::FlatScene& flat = state.scene.flat;
  if (!state.primitives) state.primitives = flatten::hash_of_primitives(flat);
  return {.scene = flatten::scene_hash(*state.primitives, flat),
          .settings = hash_of(settings_in_full(job)),
          .build = hash_of(build_in_full(state)),
          .settings_text = settings_in_words(job),
          .build_text = build_in_words(state)};
}

void open_checkpoint(State& state, Job& job) {
  RenderOptions& o = job.options;
  job.checkpoint = std::make_shared<checkpoint::FrameCheckpoint>(
      *o.ledger, identity_of(state, job), cut_of(job), o.tile_width > 0, makers(state));
  o.tile_width = static_cast<int>(job.checkpoint->cut().tile_width);
  o.tile_height = static_cast<int>(job.checkpoint->cut().tile_height);
}

namespace {

constexpr transport::Tag kFrame = transport::kTagsOfFrames.first;

checkpoint::Cut cut_of_schedule(State& state, const Job& job) {
  const wavefront::Schedule schedule = state.scheduler.schedule_for(state.devices.first(), job);
  return {job.frame.width, job.frame.height, schedule.tile_width, schedule.tile_height};
}

// What follows the header.
struct Rest {
  std::uint64_t film_bytes = 0;  // of PDPRT
  std::uint32_t mode = 0, unused = 0;
};

Mode lead(State& state, Job& job, Mode mode) {
  const checkpoint::Header header{.identity = identity_of(state, job),
                                  .cut = job.checkpoint ? job.checkpoint->cut() : cut_of_schedule(state, job),
                                  .maker = "rank 0"};
  if (mode == Mode::pdprt) job.film_of_ranks = film_bytes(state, job);
  job.shared_frame = header.frame();
  job.options.tile_width = static_cast<int>(header.cut.tile_width);
  job.options.tile_height = static_cast<int>(header.cut.tile_height);
  transport::Bytes bytes = checkpoint::to_bytes(header);
  const Rest rest{job.film_of_ranks, static_cast<std::uint32_t>(mode)};
  bytes.append(reinterpret_cast<const char*>(&rest), sizeof rest);
  state.ranks->send_to_others(kFrame, bytes);
  return mode;
}

void check_same(const checkpoint::Identity& own, const checkpoint::Identity& first) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::input,
                fmt::format("this rank has {} than rank 0; all of them need the same", what));
  };
  if (own.build != first.build)
    refuse(fmt::format("another kdray or driver ({}; there: {})", own.build_text, first.build_text));
  if (own.scene != first.scene) refuse("another scene");
  if (own.settings != first.settings) refuse(fmt::format("other settings ({})", own.settings_text));
}

Mode follow(State& state, Job& job) {
  const transport::Message message = state.ranks->wait(transport::kTagsOfFrames);
  const auto header = checkpoint::header_of(message.bytes);
  Rest rest;
  if (message.from == 0 && header && message.bytes.size() == checkpoint::kHeaderBytes + sizeof rest)
    std::memcpy(&rest, message.bytes.data() + checkpoint::kHeaderBytes, sizeof rest);
  const auto mode = static_cast<Mode>(rest.mode);
  if (!header || (mode != Mode::pdprt && mode != Mode::odprt))
    throw Error(ErrorCode::input, "rank 0 is of another version of kdray than this rank");
  check_same(identity_of(state, job), header->identity);
  job.options.tile_width = static_cast<int>(header->cut.tile_width);
  job.options.tile_height = static_cast<int>(header->cut.tile_height);
  job.shared_frame = header->frame();
  if (mode == Mode::odprt) return mode;
  const std::uint64_t film = rest.film_bytes;
  if (const std::size_t own = film_bytes(state, job); own < film)
    throw Error(ErrorCode::out_of_memory,
                fmt::format("this rank's devices have room for {} MiB of a film, rank 0's for {}", own >> 20,
                            film >> 20));
  job.film_of_ranks = film;
  return mode;
}

}  // namespace

Mode agree(State& state, Job& job, Mode mode) {
  return state.ranks->leads() ? lead(state, job, mode) : follow(state, job);
}

}  // namespace kdray::api
