// What    A kernel whose arguments are set by name: Kernel<kernels::Shade> takes
//         set(kernels::Shade::first_light, 0u). Names, order and types come from the list that the kernel's
//         parameters are made of (kernels/layout/arguments.h).
// Shape   kernels::Shade and its like hold an Argument for each entry of the kernel's list. A name that the
//         kernel doesn't have, or a value of another type than the list says, does not compile. An array
//         takes a cl::Buffer.
// Errors  ErrorCode::internal: the kernel as built takes another number of arguments than its list has (at
//         construction), or is to be launched before all of them are set (ready()). cl::Error from OpenCL's
//         own calls.
#pragma once

#include <cstdint>
#include <iterator>
#include <span>
#include <type_traits>

#include "device/opencl/opencl.h"
#include "layout/arguments.h"

namespace kdray::device {

// An argument by its index among the kernel's, and the type of what it is set to. Indices of different
// kernels are of different types.
template <auto kIndex, class Value>
struct Argument {};

// What is the same for all kernels.
class AnyKernel {
 public:
  AnyKernel(const AnyKernel&) = delete;  // a copy would set the same kernel's arguments without knowing of it
  AnyKernel(AnyKernel&&) = default;

  // Returns the kernel for a launch; throws unless every argument has been set.
  const cl::Kernel& ready() const;

 protected:
  // `parameters`: their names, in order.
  AnyKernel(const cl::Program& program, const char* name, std::span<const char* const> parameters);

  template <class Value>
  void set_at(cl_uint index, const Value& value) {
    kernel_.setArg(index, value);
    unset_ &= ~(std::uint64_t{1} << index);
  }

 private:
  cl::Kernel kernel_;
  const char* name_;
  std::span<const char* const> parameters_;
  std::uint64_t unset_;  // a bit for each argument
};

// The kernel that K describes (KDRAY_DECLARE_KERNEL).
template <class K>
class Kernel : public AnyKernel {
 public:
  explicit Kernel(const cl::Program& program) : AnyKernel(program, K::kFunction, K::kParameters) {}

  template <auto kIndex, class Value, class Given>
  Kernel& set(Argument<kIndex, Value>, const Given& value) {
    static_assert(std::is_same_v<std::remove_const_t<decltype(kIndex)>, typename K::Index>,
                  "this is another kernel's argument");
    static_assert(std::is_same_v<Value, Given>, "the kernel's list has another type for this argument");
    set_at(static_cast<cl_uint>(kIndex), value);
    return *this;
  }
};

}  // namespace kdray::device

// For functions that set the same things for several kernels: sets the argument `name` where the kernel K has
// one.
#define KDRAY_SET_WHERE_TAKEN(K, kernel, name, value) \
  if constexpr (requires { K::name; }) (kernel).set(K::name, value)

// Declares a struct that describes a kernel, from its list: see KDRAY_KERNELS.
#define KDRAY_DECLARE_KERNEL(Name, file, function, LIST)                                  \
  struct Name {                                                                           \
    enum class Index : cl_uint { LIST(KDRAY_INDEX, KDRAY_INDEX) kCount };                 \
    LIST(KDRAY_ARGUMENT, KDRAY_ARGUMENT)                                                  \
    static constexpr const char* kFile = file;                                            \
    static constexpr const char* kFunction = #function;                                   \
    static constexpr const char* kParameters[] = {LIST(KDRAY_SPELT, KDRAY_SPELT)};        \
    static_assert(std::size(kParameters) <= 64, "AnyKernel has a bit for each argument"); \
  };
#define KDRAY_INDEX(access, type, name) name,
#define KDRAY_ARGUMENT(access, type, name) \
  static constexpr kdray::device::Argument<Index::name, KDRAY_TYPE_##access(type)> name{};
#define KDRAY_TYPE_IN(type) cl::Buffer
#define KDRAY_TYPE_OUT(type) cl::Buffer
#define KDRAY_TYPE_IO(type) cl::Buffer
#define KDRAY_TYPE_CONSTANT(type) cl::Buffer
#define KDRAY_TYPE_VALUE(type) type  // as OpenCL C names it; kdray::kernels has the names
// How the kernel's parameter is spelt.
#define KDRAY_SPELT(access, type, name) KDRAY_SPELT_##access(name),
#define KDRAY_SPELT_IN(name) "in_" #name
#define KDRAY_SPELT_OUT(name) "out_" #name
#define KDRAY_SPELT_IO(name) "io_" #name
#define KDRAY_SPELT_CONSTANT(name) #name
#define KDRAY_SPELT_VALUE(name) #name

namespace kdray::kernels {
using u32 = std::uint32_t;
using float4 = cl_float4;
KDRAY_KERNELS(KDRAY_DECLARE_KERNEL)
}  // namespace kdray::kernels
