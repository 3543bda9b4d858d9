// What    The lists of kernel arguments (layout/arguments.h) against the kernels as compiled, and what is
//         refused.
#include "device/opencl/kernel.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/simd.h"
#include "kernels.h"
#include "support/device.h"
#include "support/errors.h"

// A kernel of this test's. Its source has the parameters that TAKES_ARGUMENTS says; the second struct says
// them wrongly.
#define TAKES_ARGUMENTS(F, X) \
  F(IN, float, numbers)       \
  X(VALUE, u32, n)            \
  X(OUT, float, sums)
#define LACKS_ARGUMENTS(F, X) \
  F(IN, float, numbers)       \
  X(OUT, float, sums)

namespace kdray::kernels {
KDRAY_DECLARE_KERNEL(Takes, "test.cl", add_up, TAKES_ARGUMENTS)
KDRAY_DECLARE_KERNEL(Lacks, "test.cl", add_up, LACKS_ARGUMENTS)
}  // namespace kdray::kernels

namespace kdray::device {
namespace {

constexpr const char* kSource =
    "__kernel void add_up(__global const float* in_numbers, uint n, __global float* out_sums) {\n"
    "  for (uint i = 0; i < n; ++i) out_sums[0] += in_numbers[i];\n"
    "}\n";

// A parameter as the list has it.
struct Parameter {
  std::string access, type, name;
};

struct Listed {
  const char *file, *function;
  std::vector<Parameter> parameters;
};

std::vector<Listed> all_kernels() {
#define KDRAY_TEST_PARAMETER(access, type, name) {#access, #type, #name},
#define KDRAY_TEST_KERNEL(Name, file, function, LIST) \
  {file, #function, {LIST(KDRAY_TEST_PARAMETER, KDRAY_TEST_PARAMETER)}},
  return {KDRAY_KERNELS(KDRAY_TEST_KERNEL)};
#undef KDRAY_TEST_KERNEL
#undef KDRAY_TEST_PARAMETER
}

std::string spelt(const Parameter& p) {
  if (p.access == "IN") return "in_" + p.name;
  if (p.access == "OUT") return "out_" + p.name;
  return p.access == "IO" ? "io_" + p.name : p.name;
}

cl_kernel_arg_address_qualifier space_of(const Parameter& p) {
  if (p.access == "VALUE") return CL_KERNEL_ARG_ADDRESS_PRIVATE;
  return p.access == "CONSTANT" ? CL_KERNEL_ARG_ADDRESS_CONSTANT : CL_KERNEL_ARG_ADDRESS_GLOBAL;
}

// Without the 0 that some runtimes leave at its end.
std::string text_of(std::string text) {
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

TEST(KernelListTest, EveryKernelFileHasAList) {
  std::set<std::string> files, listed;
  for (const kernels::Source& source : kernels::sources())
    if (source.name.ends_with(".cl")) files.emplace(source.name);
  for (const Listed& kernel : all_kernels()) listed.emplace(kernel.file);
  EXPECT_EQ(files, listed);
}

class KernelTest : public test::EachDevice {};

// As compiled for this device, with the compiler's own record of the parameters' names.
TEST_P(KernelTest, EveryListAgreesWithItsKernelAsCompiled) {
  const Context context(GetParam(), 1);
  const std::vector<Listed> kernels = all_kernels();
  for (const Listed& listed : kernels) {
    SCOPED_TRACE(listed.file);
    const cl::Program program =
        context.build(listed.file, "-cl-std=CL1.2 -cl-kernel-arg-info " + build_option(context.simd()));
    const cl::Kernel kernel(program, listed.function);
    ASSERT_EQ(kernel.getInfo<CL_KERNEL_NUM_ARGS>(), listed.parameters.size());
    for (cl_uint i = 0; i < listed.parameters.size(); ++i) {
      const Parameter& parameter = listed.parameters[i];
      std::string name;
      if (kernel.getArgInfo(i, CL_KERNEL_ARG_NAME, &name) != CL_SUCCESS)
        GTEST_SKIP() << "no names on this device";
      EXPECT_EQ(text_of(name), spelt(parameter));
      EXPECT_EQ(kernel.getArgInfo<CL_KERNEL_ARG_ADDRESS_QUALIFIER>(i), space_of(parameter)) << name;
      const bool read_only =
          (kernel.getArgInfo<CL_KERNEL_ARG_TYPE_QUALIFIER>(i) & CL_KERNEL_ARG_TYPE_CONST) != 0;
      EXPECT_EQ(read_only, parameter.access == "IN" || parameter.access == "CONSTANT") << name;
    }
  }
}

TEST_P(KernelTest, AListOfAnotherLengthIsRefused) {
  const Context context(GetParam(), 1);
  const cl::Program program = context.build_text("test.cl", kSource, "-cl-std=CL1.2");
  const Kernel<kernels::Takes> right(program);
  EXPECT_TRUE(test::fails([&] { const Kernel<kernels::Lacks> wrong(program); },
                          "the kernel add_up takes 3 arguments and its list has 2", ErrorCode::internal));
}

TEST_P(KernelTest, AnArgumentThatIsNotSetIsNamedBeforeTheLaunch) {
  using K = kernels::Takes;
  const Context context(GetParam(), 1);
  Kernel<K> kernel(context.build_text("test.cl", kSource, "-cl-std=CL1.2"));
  const std::vector<float> numbers = {1, 2, 4};
  const cl::Buffer in = context.upload_copy(numbers.data(), numbers.size() * sizeof(float), "numbers");
  float sum = 8;
  const cl::Buffer out = context.upload_copy(&sum, sizeof sum, "a sum");
  kernel.set(K::sums, out).set(K::numbers, in);
  EXPECT_TRUE(test::fails([&] { (void)kernel.ready(); }, "without its argument n;", ErrorCode::internal));
  kernel.set(K::n, cl_uint{3});
  checked("adding up", [&] {
    const cl::CommandQueue& queue = context.queues().front();
    queue.enqueueNDRangeKernel(kernel.ready(), cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    queue.enqueueReadBuffer(out, CL_TRUE, 0, sizeof sum, &sum);
  });
  EXPECT_EQ(sum, 15);
}

KDRAY_FOR_EACH_DEVICE(KernelTest);

}  // namespace
}  // namespace kdray::device
