#include "api/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "accel/flatten/scene_hash.h"
#include "api/names.h"
#include "api/precision.h"
#include "base/hash.h"
#include "checkpoint_fingerprint.h"
#include "device/opencl/program.h"
#include "engine/pdprt/tile_size.h"

namespace kdray::api {

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
  return text + fmt::format("{} {} {} {} {} {} {} {:a} {}", f.width, f.height, f.n_samples, f.max_depth,
                            f.corner_grid, f.keep_weightless, f.parallel, job.options.adaptive_target,
                            name_of(job.options.precision));
}

std::string settings_in_words(const Job& job) {
  const layout::Frame& f = job.frame;
  const double target = job.options.adaptive_target;
  const std::string samples =
      target > 0 ? fmt::format("adaptive:{:.4g}", target) : std::to_string(f.n_samples);
  return fmt::format("--size {}x{} --samples {} --depth {} --min-weight {:.4g}{}{}", f.width, f.height,
                     samples, f.max_depth, job.options.min_weight,
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
  const std::uint32_t largest = f.n_samples >= 16 ? 8 : f.n_samples >= 4 ? 16 : pdprt::kLargestTile;
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

}  // namespace kdray::api
