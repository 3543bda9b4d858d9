// What there is to trace with.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "device/opencl/platform.h"
#include "interrupt.h"
#include "parts.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;

nb::dict facts_of(const DeviceInfo& d) {
  nb::dict facts;
  facts["number"] = d.number;
  facts["name"] = d.name;
  facts["platform"] = d.platform;
  facts["version"] = d.version;
  facts["driver"] = d.driver;
  facts["kind"] = d.kind;
  facts["compute_units"] = d.compute_units;
  facts["memory"] = d.global_memory;
  facts["vectors"] = d.vectors;
  facts["double_precision"] = d.double_precision;
  facts["usable"] = d.usable;
  facts["why_not"] = d.why_not;
  return facts;
}

}  // namespace

void add_devices(nb::module_& module) {
  module.def("devices", [] {
    std::vector<DeviceInfo> found;
    std::vector<std::string> left_out;
    {
      const WithoutGil released;
      DeviceOptions options;
      options.programs = default_program_folder();
      options.left_out = [&](const std::string& why) { left_out.push_back(why); };
      found = devices(options);
    }
    nb::list all;
    for (const DeviceInfo& device : found) all.append(facts_of(device));
    return nb::make_tuple(all, left_out);
  });
  module.def(
      "keep_programs",
      [] {
        DeviceOptions options;
        options.programs = default_program_folder();
        keep_programs(options);
      },
      Released());
  module.def(
      "require_device",
      [](const std::string& device) {
        DeviceOptions options;
        options.device = device;
        options.programs = default_program_folder();
        require_device(options);
      },
      Released());
  module.def("refuse_after_fork", &device::refuse_after_fork);
  module.def("set_texture_cache", &set_texture_cache);
  module.def("program_folder", [] { return default_program_folder().string(); });
}

}  // namespace kdray::python
