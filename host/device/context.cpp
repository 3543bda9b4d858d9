#include "device/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "base/memory.h"
#include "device/host_memory.h"
#include "device/opencl_error.h"
#include "device/pocl_cache.h"
#include "device/program.h"

namespace kdray::device {

namespace {

// `n` equal parts of the device's first `units` compute units, or the device itself when it can't be divided.
std::vector<cl::Device> divide(cl::Device device, int n, cl_uint units) {
  const cl_uint parts = std::min<cl_uint>(static_cast<cl_uint>(n), units);
  const bool whole = units == device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  if (parts < 2 && whole) return {device};
  const cl_device_partition_property by_counts = CL_DEVICE_PARTITION_BY_COUNTS;
  std::vector<cl_device_partition_property> properties{by_counts};
  for (cl_uint i = 0; i < parts; ++i)
    properties.push_back(
        static_cast<cl_device_partition_property>(units / parts + (i < units % parts ? 1 : 0)));
  properties.push_back(CL_DEVICE_PARTITION_BY_COUNTS_LIST_END);
  properties.push_back(0);
  std::vector<cl::Device> sub_devices;
  try {
    device.createSubDevices(properties.data(), &sub_devices);
  } catch (const cl::Error&) {
    if (!whole)
      throw Error(ErrorCode::no_device,
                  fmt::format("the device can't be cut down to {} of its compute units", units));
    return {device};  // most GPUs
  }
  return sub_devices;
}

Opened open(const cl::Device& device, int n_queues, cl_uint units) {
  Opened opened;
  opened.devices = divide(device, n_queues, units);
  opened.context = cl::Context(opened.devices);
  for (int i = 0; i < n_queues; ++i)
    opened.queues.emplace_back(opened.context,
                               opened.devices[static_cast<std::size_t>(i) % opened.devices.size()],
                               cl_command_queue_properties{CL_QUEUE_PROFILING_ENABLE});
  return opened;
}

std::vector<std::string> split(const std::string& specs) {
  std::vector<std::string> parts;
  for (std::size_t first = 0; first <= specs.size();) {
    const std::size_t comma = std::min(specs.find(',', first), specs.size());
    parts.push_back(specs.substr(first, comma - first));
    first = comma + 1;
  }
  return parts;
}

// What is opened is never destroyed, on purpose: see the header.
const Opened& opened_before_or_now(const FoundDevice& found, int n_queues) {
  static std::mutex mutex;
  static auto* all = new std::map<std::tuple<int, int, cl_uint>, Opened>;
  const std::lock_guard lock(mutex);
  const std::tuple key{found.info.number, n_queues, found.info.compute_units};
  auto place = all->find(key);
  if (place == all->end())
    place = all->emplace(key, open(found.device, n_queues, found.info.compute_units)).first;
  return place->second;
}

}  // namespace

Context::Context(const std::string& device_spec, int n_queues, int compute_units, Builds builds)
    : found_(choose_device(device_spec)), builds_(std::move(builds)) {
  if (is_pocl(found_.info.platform) && !pocl_cache().unusable.empty())
    throw Error(ErrorCode::input, pocl_cache().unusable);
  if (compute_units > 0)
    found_.info.compute_units =
        std::min(found_.info.compute_units, static_cast<std::uint32_t>(compute_units));
  checked("opening " + found_.info.name, [&] { opened_ = &opened_before_or_now(found_, n_queues); });
  const SimdChoice simd = choose_simd(found_, *opened_, builds_);
  simd_ = simd.form;
  found_.info.vectors = in_words(simd_);
  found_.info.vectors_refused = simd.refused_in_words();
}

Context Context::without_cache() const {
  Context copy = *this;
  copy.builds_.cache = nullptr;
  return copy;
}

std::size_t Context::max_work_group() const {
  return checked("asking " + found_.info.name,
                 [&] { return found_.device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>(); });
}

bool Context::rounds_division_correctly() const {
  return checked("asking " + found_.info.name, [&] {
    return (found_.device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
  });
}

cl::Program Context::build(const std::string& file, const std::string& options) const {
  return build_program(opened_->context, opened_->devices, file, options, builds_);
}

BuiltVariant Context::build(const std::string& file, const Variant& wanted) const {
  return build_variant(opened_->context, opened_->devices, file, wanted, builds_);
}

cl::Program Context::build_text(const std::string& name, const std::string& text,
                                const std::string& options) const {
  return build_source(opened_->context, opened_->devices, name, expand_text(name, text), options, builds_);
}

cl::Buffer Context::buffer(cl_mem_flags flags, std::size_t bytes, const std::string& what) const {
  if (bytes > found_.info.max_allocation)
    throw Error(
        ErrorCode::out_of_memory,
        fmt::format("{} wants {} MiB in one piece, {} gives {} MiB at most; try a smaller scene or picture",
                    what, bytes >> 20, found_.info.name, found_.info.max_allocation >> 20));
  return checked("allocating " + what, [&] {
    if (bytes >= kLargePages && works_in_host_memory()) {
      const std::shared_ptr<void> memory = allocate(bytes);
      return buffer_over(opened_->context, flags, memory.get(), bytes, memory);
    }
    return cl::Buffer(opened_->context, flags, std::max<std::size_t>(bytes, 16));
  });
}

cl::Buffer Context::sparse_buffer(cl_mem_flags flags, std::size_t bytes, const std::string& what) const {
  if (bytes < kLargePages || bytes > found_.info.max_allocation) return buffer(flags, bytes, what);
  return checked("allocating " + what, [&] { return cl::Buffer(opened_->context, flags, bytes); });
}

cl::Buffer Context::buffer_made_beside(cl_mem_flags flags, std::size_t bytes, const std::string& what,
                                       bool zeroed, std::future<void>& made) const {
  const bool in_host_memory = bytes >= kLargePages && bytes <= found_.info.max_allocation &&
                              checked("asking", [&] { return works_in_host_memory(); });
  if (!in_host_memory) return buffer(flags, bytes, what);
  return checked("allocating " + what, [&] {
    const std::shared_ptr<void> memory = allocate(bytes);
    made = std::async(std::launch::async, [memory, bytes, zeroed] {
      make_pages(memory.get(), bytes);
      if (zeroed) std::memset(memory.get(), 0, bytes);
    });
    return buffer_over(opened_->context, flags, memory.get(), bytes, memory);
  });
}

cl::Buffer Context::upload(const void* data, std::size_t bytes, std::shared_ptr<void> owner,
                           const std::string& what) const {
  const bool in_place = bytes > 0 && bytes <= found_.info.max_allocation &&
                        checked("asking", [&] { return works_in_host_memory(); });
  if (in_place)
    return checked("sharing " + what, [&] {
      return buffer_over(opened_->context, CL_MEM_READ_ONLY, data, bytes, std::move(owner));
    });
  return upload_copy(data, bytes, what);
}

cl::Buffer Context::upload_copy(const void* data, std::size_t bytes, const std::string& what) const {
  cl::Buffer copy = buffer(CL_MEM_READ_ONLY, bytes, what);
  if (bytes > 0)
    checked("uploading " + what, [&] { queues().front().enqueueWriteBuffer(copy, CL_TRUE, 0, bytes, data); });
  return copy;
}

bool Context::works_in_host_memory() const {
  return found_.device.getInfo<CL_DEVICE_TYPE>() == CL_DEVICE_TYPE_CPU &&
         found_.device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>() == CL_TRUE;
}

namespace {

Context open_checked(const std::string& spec, int n_queues, const OpenOptions& o) {
  Context context(spec, n_queues, o.compute_units, o.builds);
  if (o.check) o.check(context);
  return context;
}

// The best device that can be opened and passes.
Context open_best(int n_queues, const OpenOptions& o) {
  std::string why;
  for (const int number : devices_by_preference()) {
    try {
      Context context = open_checked(std::to_string(number), n_queues, o);
      if (!why.empty() && o.left_out) o.left_out(why);
      return context;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::no_device) throw;
      if (!why.empty() && o.left_out) o.left_out(why);
      why = error.what();
    }
  }
  if (!why.empty()) throw Error(ErrorCode::no_device, why);
  return Context("auto", n_queues);  // throws, saying what there is
}

}  // namespace

std::vector<Context> open_contexts(const std::string& specs, const OpenOptions& options) {
  const std::vector<std::string> parts = split(specs);
  const int n = static_cast<int>(parts.size());
  std::vector<Context> contexts;
  for (int i = 0; i < n; ++i) {
    const std::string& spec = parts[static_cast<std::size_t>(i)];
    if (n > 1 && spec.empty())
      throw Error(ErrorCode::usage, fmt::format("the list of devices '{}' has an empty name in it", specs));
    const int queues = std::max(options.n_queues / n + (i < options.n_queues % n ? 1 : 0), 1);
    contexts.push_back(is_auto(spec) ? open_best(queues, options) : open_checked(spec, queues, options));
  }
  return contexts;
}

std::vector<Context> open_contexts(const std::string& specs, int n_queues, int compute_units) {
  OpenOptions options;
  options.n_queues = n_queues;
  options.compute_units = compute_units;
  return open_contexts(specs, options);
}

}  // namespace kdray::device
