// What    kdray devices: the OpenCL devices of this machine, numbered as --device takes them.
#include <fmt/format.h>

#include <memory>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/output.h"
#include "apps/cli/progress.h"
#include "apps/cli/stats.h"
#include "device/opencl/pocl_cache.h"
#include "kdray/kdray.h"

namespace kdray::cli {

namespace {

std::string as_text(const std::vector<DeviceInfo>& devices, const std::vector<std::string>& left_out) {
  std::string text;
  for (const DeviceInfo& d : devices) {
    text += fmt::format("{}  {}\n", d.number, one_line(d.name));
    text += fmt::format("   {}, {} compute units, {} of memory ({} in one piece)\n", d.kind, d.compute_units,
                        bytes_in_words(d.global_memory), bytes_in_words(d.max_allocation));
    text +=
        fmt::format("   {}, {}, driver {}\n", one_line(d.platform), one_line(d.version), one_line(d.driver));
    if (d.usable)
      text +=
          fmt::format("   vectors: {}{}; double precision: {}\n", d.vectors,
                      d.vectors_refused.empty() ? "" : fmt::format(" (not {})", one_line(d.vectors_refused)),
                      d.double_precision ? "yes" : "no");
    if (!d.usable) text += fmt::format("   not usable: {}\n", one_line(d.why_not));
  }
  for (const std::string& why : left_out) text += fmt::format("left out: {}\n", one_line(why));
  return text;
}

std::string as_json(const std::vector<DeviceInfo>& devices) {
  Json list = Json::array();
  for (const DeviceInfo& d : devices)
    list.push_back({{"number", d.number},
                    {"name", d.name},
                    {"platform", d.platform},
                    {"version", d.version},
                    {"driver", d.driver},
                    {"kind", d.kind},
                    {"compute_units", d.compute_units},
                    {"global_memory", d.global_memory},
                    {"max_allocation", d.max_allocation},
                    {"vectors", d.vectors},
                    {"vectors_refused", d.vectors_refused},
                    {"double_precision", d.double_precision},
                    {"usable", d.usable},
                    {"why_not", d.why_not}});
  return list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int run(bool json) {
  DeviceOptions options;
  options.programs = default_program_folder();
  std::vector<std::string> left_out;
  options.left_out = [&](const std::string& why) { left_out.push_back(why); };
  BuildNotice::Output output = notice_on_stderr(false);
  output.text = "compiling kernels to test the devices; later runs know the outcome";
  BuildNotice notice(output);
  options.building = [&](bool begins) { notice.tell(begins); };
  const std::vector<DeviceInfo> all = devices(options);
  notice.mute();
  print(json ? as_json(all) : as_text(all, left_out));
  if (json)
    for (const std::string& why : left_out) say("left out: " + why);
  for (const DeviceInfo& d : all)
    if (d.usable) return 0;
  if (const std::string& why = device::pocl_cache().unusable; all.empty() && !why.empty())
    throw Error(ErrorCode::no_device, "no OpenCL device found; " + why);
  throw Error(ErrorCode::no_device, all.empty()
                                        ? "no OpenCL device found; 'kdray doctor' says what is missing"
                                        : "no usable OpenCL device; 'kdray doctor' says more");
}

}  // namespace

Command add_devices(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("devices", "List the OpenCL devices");
  const auto json = std::make_shared<bool>(false);
  app->add_flag("--json", *json, "Print JSON");
  return {app, [json] { return run(*json); }};
}

}  // namespace kdray::cli
