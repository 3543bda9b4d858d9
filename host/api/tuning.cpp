#include "api/tuning.h"

#include <fmt/format.h>

#include "base/hash.h"
#include "device/opencl/program.h"
#include "kdray/error.h"

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

}  // namespace kdray::api
