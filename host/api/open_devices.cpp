#include "api/open_devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>

#include "base/error.h"
#include "base/hash.h"
#include "base/timer.h"
#include "device/opencl/context.h"
#include "device/opencl/fault_injector.h"
#include "device/opencl/program.h"
#include "device/opencl/program_cache.h"
#include "kdray/error.h"
#include "kdray/kdray.h"
#include "probe/selftest/self_test.h"
#include "probe/trial/devices.h"
#include "probe/trial/drivers.h"

namespace kdray::api {

tuning::Key tuning_key(const device::Context& context, bool global, layout::Features features) {
  const DeviceInfo& info = context.info();
  return {.device = fmt::format("{}, {} units", info.name, info.compute_units),
          .driver = fmt::format("{}, {}, {}", info.platform, info.version, info.driver),
          .kernels = in_hex(
              hash_of(device::expand_source("wave/wave.cl") + device::expand_source("traverse/query.cl"))),
          .schedule = global ? "global" : "slices",
          .features = tuning::features_text(features)};
}

tuning::Database read_tunings(const DeviceOptions& options) {
  if (options.tunings.empty()) return {};
  try {
    return tuning::Database::read(options.tunings);
  } catch (const Error& error) {
    if (options.tunings_ignored) options.tunings_ignored(fmt::format("{}; it is ignored", error.what()));
    return {};
  }
}

engine::Tuned tuned_for(const device::Context& context, bool global, layout::Features features,
                        const tuning::Database& tunings, const std::string& file) {
  engine::Tuned tuned{tuning::shipped(context.info().kind), tuning_key(context, global, features), "shipped"};
  if (const tuning::Entry* const entry = tunings.find(tuned.key)) {
    tuned.settings = tuning::merged(tuned.settings, entry->settings);
    tuned.from = fmt::format("{}, features {}", file, entry->key.features);
  }
  return tuned;
}

namespace {

// There is one cache for all who name this folder, so that what any of them has built is kept.
std::shared_ptr<device::ProgramCache> cache_in(const std::filesystem::path& folder) {
  static std::mutex mutex;
  // Never destroyed, on purpose: they hold OpenCL's programs (device/opencl/context.h).
  static auto* const caches = new std::map<std::filesystem::path, std::shared_ptr<device::ProgramCache>>;
  if (folder.empty()) return nullptr;
  const std::lock_guard lock(mutex);
  std::shared_ptr<device::ProgramCache>& cache = (*caches)[folder];
  if (!cache) cache = std::make_shared<device::ProgramCache>(folder);
  return cache;
}

void check(const DeviceOptions& o) {
  if (o.queues < 1 || o.queues > 1024) throw Error(ErrorCode::usage, "the number of queues may be 1 to 1024");
  if (o.work_group < 0) throw Error(ErrorCode::usage, "the work-group size may not be negative");
  if (o.compute_units < 0) throw Error(ErrorCode::usage, "the number of compute units may not be negative");
}

}  // namespace

device::Builds builds_of(const DeviceOptions& options) {
  return {.cache = cache_in(options.programs),
          .watch = options.building,
          .remember = options.remember_programs.value_or(false),
          .exact = options.exact_programs};
}

device::Verdicts verdicts_of(const DeviceOptions& options) {
  const bool keeps = !options.programs.empty();
  return device::Verdicts(keeps ? options.programs : default_program_folder(), keeps);
}

std::vector<std::string> leave_out_drivers(const DeviceOptions& o) {
  std::vector<std::string> reasons;
  const trial::ListingOptions listing{verdicts_of(o), o.device, o.building};
  for (const trial::DriverVerdict& d : trial::mind_drivers(listing))
    if (d.left_out) reasons.push_back(d.in_words());
  return reasons;
}

namespace {

// Drivers that are left out are told of; where no device is left without them, they are why.
void tell_of_drivers(const DeviceOptions& o) {
  const std::vector<std::string> reasons = leave_out_drivers(o);
  if (!reasons.empty() && device::find_devices().empty()) throw Error(ErrorCode::no_device, reasons.front());
  for (const std::string& why : reasons)
    if (o.left_out) o.left_out(why);
}

}  // namespace

OpenedDevices open_devices(const DeviceOptions& o, const std::string& faults) {
  check(o);
  device::refuse_after_fork();
  const device::FaultInjector injector(faults);
  OpenedDevices opened;
  device::OpenOptions options;
  options.n_queues = o.queues;
  options.compute_units = o.compute_units;
  options.builds = builds_of(o);
  options.left_out = o.left_out;
  trial::DeviceTrials trials(verdicts_of(o), false, o.building);
  options.judge = [&](const std::vector<device::FoundDevice>& candidates, std::size_t i) {
    const Timer timer;
    const std::string why = trials.why_not(candidates, i);
    opened.seconds.self_test += timer.seconds();
    return why;
  };
  options.check = [&](const device::Context& context) {
    const Timer timer;
    selftest::require(context, injector.fails_self_test(context.info().number));
    opened.seconds.self_test += timer.seconds();
  };
  const Timer timer;
  tell_of_drivers(o);
  opened.contexts = device::open_contexts(o.device, options);
  opened.seconds.start = timer.seconds() - opened.seconds.self_test;
  return opened;
}

std::shared_ptr<engine::DeviceScene> open_scene(const prepare::Prepared& scene, const DeviceOptions& options,
                                                const Hooks& hooks) {
  const OpenedDevices opened = open_devices(options, hooks.faults);
  const tuning::Database tunings = read_tunings(options);
  const auto tuned = [&](const device::Context& context, bool global) {
    return tuned_for(context, global, scene.features, tunings, options.tunings.string());
  };
  const auto devices =
      std::make_shared<engine::DeviceScene>(scene, opened.contexts, options, hooks.build_options, tuned);
  devices->open_seconds = {opened.seconds.start, opened.seconds.self_test};
  return devices;
}

OpenSeconds open_device(const DeviceOptions& options, const Hooks& hooks) {
  const OpenedDevices opened = open_devices(options, hooks.faults);
  for (const device::Context& context : opened.contexts) engine::work_group_of(options, context);
  return opened.seconds;
}

}  // namespace kdray::api

namespace kdray {

namespace fs = std::filesystem;

OpenSeconds open_device(const DeviceOptions& options) {
  return api::open_device(options, {});
}

fs::path default_program_folder() {
  const fs::path scenes = SceneCache::default_folder();
  if (scenes.empty()) return {};
  return std::getenv("KDRAY_CACHE_DIR") ? scenes / "programs" : scenes.parent_path() / "programs";
}

void require_device(const DeviceOptions& options) {
  api::check(options);
  device::refuse_after_fork();
  api::tell_of_drivers(options);
  device::require_devices(options.device);
}

void keep_programs(const DeviceOptions& options) {
  if (device::is_forked_off()) return;  // nothing was built here
  if (const auto cache = api::cache_in(options.programs)) cache->keep();
}

namespace {

DeviceInfo unusable(DeviceInfo info, const std::string& why) {
  info.usable = false;
  info.why_not = why;
  return info;
}

// Adds what only an opened device can tell: the form of its vectors, and whether it computes rightly at all.
DeviceInfo opened(const DeviceInfo& listed, const DeviceOptions& options) {
  try {
    DeviceOptions one = options;
    one.device = std::to_string(listed.number);
    one.queues = 1;
    return api::open_devices(one).contexts.front().info();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_device) throw;
    return unusable(listed, error.what());
  }
}

}  // namespace

std::vector<DeviceInfo> devices(const DeviceOptions& options) {
  device::refuse_after_fork();
  for (const std::string& why : api::leave_out_drivers(options))
    if (options.left_out) options.left_out(why);
  std::vector<DeviceInfo> infos;
  const std::vector<device::FoundDevice> found = device::find_devices();
  std::vector<device::FoundDevice> usable;
  std::ranges::copy_if(found, std::back_inserter(usable), [](const auto& d) { return d.info.usable; });
  trial::DeviceTrials trials(api::verdicts_of(options), true, options.building);
  for (std::size_t i = 0, u = 0; i < found.size(); ++i) {
    const DeviceInfo& info = found[i].info;
    const std::string why = info.usable ? trials.why_not(usable, u++) : "";
    infos.push_back(!info.usable ? info : why.empty() ? opened(info, options) : unusable(info, why));
  }
  return infos;
}

}  // namespace kdray
