#include "device/opencl/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>

#include "base/memory.h"
#include "base/text.h"
#include "device/opencl/buffers.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/pocl_cache.h"
#include "device/opencl/program.h"

namespace kdray::device {

namespace {

// Returns `n` equal parts of the device's first `units` compute units, or the device itself when it can't be
// divided.
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

OpenDevice open(const cl::Device& device, int n_queues, cl_uint units) {
  OpenDevice opened;
  opened.devices = divide(device, n_queues, units);
  opened.context = cl::Context(opened.devices);
  for (int i = 0; i < n_queues; ++i)
    opened.queues.emplace_back(opened.context,
                               opened.devices[static_cast<std::size_t>(i) % opened.devices.size()],
                               cl_command_queue_properties{CL_QUEUE_PROFILING_ENABLE});
  return opened;
}

// What is opened is never destroyed, on purpose: see the header.
const OpenDevice& opened_before_or_now(const FoundDevice& found, int n_queues) {
  static std::mutex mutex;
  static auto* all = new std::map<std::tuple<int, int, cl_uint>, OpenDevice>;
  const std::lock_guard lock(mutex);
  const std::tuple key{found.info.number, n_queues, found.info.compute_units};
  auto place = all->find(key);
  if (place == all->end())
    place = all->emplace(key, open(found.device, n_queues, found.info.compute_units)).first;
  return place->second;
}

// Returns how many bytes of buffers a device may keep for the next frame.
std::size_t most_kept(const DeviceInfo& info, bool in_host_memory) {
  constexpr std::size_t kOfHost = std::size_t{512} << 20;
  const std::size_t share = info.global_memory / 8;
  return in_host_memory ? std::min(share, kOfHost) : share;
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
  kept_ = std::make_shared<KeptBuffers>(
      most_kept(found_.info, checked("asking " + found_.info.name, [&] { return works_in_host_memory(); })));
}

Context Context::without_cache() const {
  Context copy = *this;
  copy.builds_.cache = nullptr;
  copy.builds_.remember = false;
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

bool Context::adds_64_bits_atomically() const {
  return checked("asking " + found_.info.name, [&] {
    return found_.device.getInfo<CL_DEVICE_EXTENSIONS>().find("cl_khr_int64_base_atomics") !=
           std::string::npos;
  });
}

namespace {

// Programs by all that they are made of. Like what is opened, they are never destroyed.
class RememberedPrograms {
 public:
  using Key = std::tuple<const OpenDevice*, std::string, std::string, std::string>;

  template <class Build>
  static BuiltVariant find_or(const Key& key, const Build& build) {
    static auto* all = new RememberedPrograms;
    {
      const std::lock_guard lock(all->mutex_);
      if (const auto place = all->programs_.find(key); place != all->programs_.end()) {
        BuiltVariant found = place->second;
        found.compiled = false;
        return found;
      }
    }
    const BuiltVariant built = build();  // side by side with others
    const std::lock_guard lock(all->mutex_);
    all->programs_.emplace(key, built);
    return built;
  }

 private:
  std::mutex mutex_;
  std::map<Key, BuiltVariant> programs_;
};

}  // namespace

cl::Program Context::build(const std::string& file, const std::string& options) const {
  return build_program(opened_->context, opened_->devices, file, options, builds_);
}

BuiltVariant Context::build(const std::string& file, const Variant& wanted) const {
  const auto build = [&] { return build_variant(opened_->context, opened_->devices, file, wanted, builds_); };
  if (!builds_.remember) return build();
  const char* const folder = std::getenv("KDRAY_KERNEL_DIR");
  return RememberedPrograms::find_or(
      {opened_, folder ? folder : "", file, options_with(wanted.options, wanted.mask)}, build);
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
    return made(flags, std::max(bytes, kLeastBufferBytes));
  });
}

// Returns a new buffer. Where there is no memory for it, what frames have left is given up.
cl::Buffer Context::made(cl_mem_flags flags, std::size_t bytes) const {
  try {
    return cl::Buffer(opened_->context, flags, bytes);
  } catch (const cl::Error& error) {
    if (fault_of(error.err()) != Fault::memory || kept_->bytes() == 0) throw;
    kept_->clear();
  }
  return cl::Buffer(opened_->context, flags, bytes);
}

cl::Buffer Context::kept_buffer(std::size_t bytes, const std::string& what) const {
  const std::optional<cl::Buffer> kept = kept_->take(bytes);
  return kept ? *kept : buffer(CL_MEM_READ_WRITE, bytes, what);
}

cl::Buffer Context::sparse_buffer(cl_mem_flags flags, std::size_t bytes, const std::string& what) const {
  if (bytes < kLargePages || bytes > found_.info.max_allocation) return buffer(flags, bytes, what);
  return checked("allocating " + what, [&] { return made(flags, bytes); });
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

cl::Buffer Context::lend(void* data, std::size_t bytes, const std::string& what) const {
  return checked("lending " + what, [&] {
    if (bytes == 0 || bytes > found_.info.max_allocation || !works_in_host_memory()) return cl::Buffer();
    return buffer_over(opened_->context, CL_MEM_WRITE_ONLY, data, bytes, nullptr);
  });
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

// Returns a context that may be opened and passes the check; else sets `why` it can't be used.
std::optional<Context> try_to_open(const std::vector<FoundDevice>& candidates, std::size_t i, int n_queues,
                                   const OpenOptions& o, std::string& why) {
  if (o.judge) why = o.judge(candidates, i);
  if (!why.empty()) return std::nullopt;
  try {
    return open_checked(std::to_string(candidates[i].info.number), n_queues, o);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_device) throw;
    why = error.what();
    return std::nullopt;
  }
}

// Opens the best device of those that the spec leaves to kdray.
Context open_best(const std::string& spec, int n_queues, const OpenOptions& o) {
  std::string why;
  const std::vector<FoundDevice> candidates = devices_by_preference(spec);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::string this_one;
    const std::optional<Context> context = try_to_open(candidates, i, n_queues, o, this_one);
    if (!why.empty() && o.left_out) o.left_out(why);
    if (context) return *context;
    why = this_one;
  }
  if (!why.empty()) throw Error(ErrorCode::no_device, why);
  return Context(spec, n_queues);  // throws, saying what there is
}

}  // namespace

std::vector<Context> open_contexts(const std::string& specs, const OpenOptions& options) {
  const std::vector<std::string> parts = split_list(specs);
  const int n = static_cast<int>(parts.size());
  std::vector<Context> contexts;
  for (int i = 0; i < n; ++i) {
    const std::string& spec = parts[static_cast<std::size_t>(i)];
    if (n > 1 && spec.empty())
      throw Error(ErrorCode::usage, fmt::format("the list of devices '{}' has an empty name in it", specs));
    const int queues = std::max(options.n_queues / n + (i < options.n_queues % n ? 1 : 0), 1);
    const bool chosen = is_auto(spec) || is_kind(spec);
    contexts.push_back(chosen ? open_best(spec, queues, options) : open_checked(spec, queues, options));
  }
  return contexts;
}

void require_devices(const std::string& specs) {
  for (const std::string& spec : split_list(specs)) choose_device(spec);
}

std::vector<Context> open_contexts(const std::string& specs, int n_queues, int compute_units) {
  OpenOptions options;
  options.n_queues = n_queues;
  options.compute_units = compute_units;
  return open_contexts(specs, options);
}

}  // namespace kdray::device
