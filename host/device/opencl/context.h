// What    One OpenCL context on the chosen device and its queues: one queue on the whole device, or one per
//         sub-device (clCreateSubDevices, equal shares) when several are asked for.
// Why     What is opened stays open until the process ends, and the next Context of the same kind shares it:
//         PoCL 3.1 releases a command's event after the command is reported as done, and crashes when the
//         queue has been released in between. OpenCL's queues may be used from several threads.
// Errors  Queues beyond what the device can be divided into share its parts in turn.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "device/opencl/buffers.h"
#include "device/opencl/opencl.h"
#include "device/opencl/platform.h"
#include "device/opencl/program.h"
#include "device/opencl/simd.h"
#include "device/opencl/variant.h"

namespace kdray::device {

// An OpenCL context with its devices (the device itself, or its sub-devices) and queues.
struct OpenDevice {
  std::vector<cl::Device> devices;
  cl::Context context;
  std::vector<cl::CommandQueue> queues;
};

class Context {
 public:
  // With `compute_units` > 0, opens a sub-device of that many of the device's units, or of all where it has
  // no more; throws ErrorCode::no_device when the device can't be divided.
  Context(const std::string& device_spec, int n_queues, int compute_units = 0, Builds builds = {});

  const DeviceInfo& info() const { return found_.info; }
  const Builds& builds() const { return builds_; }
  Context without_cache() const;       // the same, but what it builds is neither looked for nor kept
  Simd simd() const { return simd_; }  // the form of vectors that kernels are to be built with
  const OpenDevice& opened() const { return *opened_; }
  const cl::Context& get() const { return opened_->context; }
  const std::vector<cl::CommandQueue>& queues() const { return opened_->queues; }
  std::size_t max_work_group() const;
  bool rounds_division_correctly() const;
  // Whether work-items can add to one 64-bit number, as films want it where every ray has a work-item.
  bool adds_64_bits_atomically() const;  // CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT
  std::size_t n_sub_devices() const { return opened_->devices.size(); }

  cl::Program build(const std::string& file, const std::string& options) const;
  BuiltVariant build(const std::string& file, const Variant& wanted) const;
  // Builds a source that is no file of kernels/, but may include such files.
  cl::Program build_text(const std::string& name, const std::string& text, const std::string& options) const;

  // Throws ErrorCode::out_of_memory, naming the device's limit, when a buffer of `bytes` is too large for it.
  // A buffer of 0 bytes is made as one of 16, since OpenCL has no empty buffers.
  cl::Buffer buffer(cl_mem_flags flags, std::size_t bytes, const std::string& what) const;

  // Does the same as buffer(), for a buffer of which only scattered pieces will be used: it asks for no large
  // pages, since each of those is cleared as a whole.
  cl::Buffer sparse_buffer(cl_mem_flags flags, std::size_t bytes, const std::string& what) const;

  // Does the same as buffer(), and makes the buffer's pages in the background where it lies in the host's
  // memory, all 0 if `zeroed`. `made` becomes ready when they are made, and no command may use the buffer
  // before; `made` is left alone where there is nothing to do. The device has to work in that very memory, as
  // a CPU with CL_DEVICE_HOST_UNIFIED_MEMORY does, since the 0s are written without OpenCL.
  cl::Buffer buffer_made_beside(cl_mem_flags flags, std::size_t bytes, const std::string& what, bool zeroed,
                                std::future<void>& made) const;

  // Returns a buffer that a frame has left in kept_buffers(), or a new one.
  cl::Buffer kept_buffer(std::size_t bytes, const std::string& what) const;
  KeptBuffers& kept_buffers() const { return *kept_; }

  // Returns a buffer for reading what lies at `data`: that memory itself where the device works in the
  // host's, which `owner` then keeps as long as the buffer lives; elsewhere a copy.
  cl::Buffer upload(const void* data, std::size_t bytes, std::shared_ptr<void> owner,
                    const std::string& what) const;
  // Returns a buffer for writing to the caller's memory, which the caller keeps as long as the buffer lives,
  // where the device works in the host's memory; elsewhere none. What commands wrote there can be read once
  // it has been mapped.
  cl::Buffer lend(void* data, std::size_t bytes, const std::string& what) const;
  // Uploads a copy of the data, also where the device could use it in place.
  cl::Buffer upload_copy(const void* data, std::size_t bytes, const std::string& what) const;

  // Returns whether the device works in the host's memory: what a kernel has written is there when it has
  // ended.
  bool works_in_host_memory() const;

 private:
  cl::Buffer made(cl_mem_flags flags, std::size_t bytes) const;

  FoundDevice found_;
  Builds builds_;
  const OpenDevice* opened_;
  Simd simd_ = Simd::portable;
  std::shared_ptr<KeptBuffers> kept_;
};

// Returns why the `i`th of the candidates, the best first, must not be opened; an empty text where it may be.
using Judge = std::function<std::string(const std::vector<FoundDevice>& candidates, std::size_t i)>;

struct OpenOptions {
  int n_queues = 1;       // in all: dealt out in turn, at least one for each device
  int compute_units = 0;  // of each device; 0: all
  Builds builds = {};
  Judge judge = {};                                // of devices that nobody asked for by name or number
  std::function<void(const Context&)> check = {};  // throws ErrorCode::no_device for a device not to be used
  // Called with the reason, where it goes on to another device.
  std::function<void(const std::string&)> left_out = {};
};

// Opens a context on each of the devices of `specs` (as choose_device() takes them, separated by commas).
// "auto" and a kind take the next device where one can't be used, can't be opened or doesn't pass the check;
// for a device that was asked for by name or number, the error is thrown on.
std::vector<Context> open_contexts(const std::string& specs, const OpenOptions& options);
std::vector<Context> open_contexts(const std::string& specs, int n_queues, int compute_units = 0);

// Throws ErrorCode::no_device where one of `specs` names no usable device; opens none.
void require_devices(const std::string& specs);

}  // namespace kdray::device
