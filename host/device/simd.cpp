#include "device/simd.h"

#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "device/context.h"
#include "device/opencl_error.h"
#include "device/program.h"
#include "device/simd_answers.h"

namespace kdray::device {

namespace {

using SimdTest = kernels::SimdTest;

std::string options_for(Simd form) {
  return "-cl-std=CL1.2 " + build_option(form);
}

bool processor_has_avx512() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("avx512f") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512bw");
#else
  return false;
#endif
}

// The x86 form's kernel, or none where the compiler refuses it: an answer, not an error, hence no report of
// it.
std::optional<Kernel<SimdTest>> try_x86_build(const Opened& opened, const Builds& builds) {
  try {
    std::string log;
    const cl::Program program = try_build(opened.context, opened.devices, expand_source(SimdTest::kFile),
                                          options_for(Simd::x86), builds, log);
    if (program() != nullptr) return Kernel<SimdTest>(program);
  } catch (const cl::Error&) {  // refused in another way
  } catch (const Error&) {
  }
  return std::nullopt;
}

std::string difference_in(const Opened& opened, Kernel<SimdTest>& kernel) {
  const std::vector<layout::SimdCase> cases = known_cases();
  return first_difference(cases, run_simd_test(opened, kernel, cases));
}

// "portable", "x86", or empty: whatever is best.
std::string asked_for() {
  const char* value = std::getenv("KDRAY_SIMD");
  const std::string_view form = value == nullptr ? "" : value;
  if (!form.empty() && form != "portable" && form != "x86")
    throw Error(ErrorCode::usage,
                fmt::format("KDRAY_SIMD is '{}'; it may be portable or x86, or unset", form));
  return std::string(form);
}

void check_portable(const FoundDevice& found, const Opened& opened, const Builds& builds) {
  const cl::Program program =
      build_program(opened.context, opened.devices, SimdTest::kFile, options_for(Simd::portable), builds);
  const std::string difference = checked("testing " + found.info.name, [&] {
    Kernel<SimdTest> kernel(program);
    return difference_in(opened, kernel);
  });
  if (!difference.empty())
    throw Error(
        ErrorCode::no_device,
        fmt::format("{} computes wrongly: {}, of the vector operations' self-test; try another device or "
                    "driver, see `kdray devices`",
                    found.info.name, difference));
}

}  // namespace

const char* in_words(Simd form) {
  return form == Simd::x86 ? "x86 AVX-512" : "portable";
}

std::string build_option(Simd form) {
  return form == Simd::x86 ? "-DKDRAY_SIMD_X86=1" : "-DKDRAY_SIMD_X86=0";
}

std::vector<layout::SimdAnswers> run_simd_test(const Opened& opened, Kernel<SimdTest>& kernel,
                                               const std::vector<layout::SimdCase>& cases) {
  std::vector<layout::SimdAnswers> answers(cases.size());
  const std::size_t in_bytes = cases.size() * sizeof(layout::SimdCase);
  const std::size_t out_bytes = cases.size() * sizeof(layout::SimdAnswers);
  const cl::Buffer in(opened.context, CL_MEM_READ_ONLY, in_bytes);
  const cl::Buffer out(opened.context, CL_MEM_WRITE_ONLY, out_bytes);
  const cl::CommandQueue& queue = opened.queues.front();
  kernel.set(SimdTest::cases, in)
      .set(SimdTest::n, static_cast<cl_uint>(cases.size()))
      .set(SimdTest::answers, out);
  queue.enqueueWriteBuffer(in, CL_TRUE, 0, in_bytes, cases.data());
  queue.enqueueNDRangeKernel(kernel.ready(), cl::NullRange, cl::NDRange(1), cl::NDRange(1));
  queue.enqueueReadBuffer(out, CL_TRUE, 0, out_bytes, answers.data());
  return answers;
}

// In this order, each question making the next one safe to ask: code with instructions that the processor
// lacks may well build (a compiler can be told any target) and then kills the process, which no self-test
// survives. The processor asked is the one this runs on, which is a CPU device's own; a GPU's or an
// accelerator's compiler need not be bothered with builtins that aren't its own.
std::string why_no_x86(const FoundDevice& found, const Opened& opened, const Builds& builds) {
  if (!processor_has_avx512()) return "the processor has no AVX-512 (F, VL, DQ and BW)";
  if (found.info.kind != "cpu") return "the device is not a CPU";
  std::optional<Kernel<SimdTest>> kernel = try_x86_build(opened, builds);
  if (!kernel) return "the device's compiler refuses the AVX-512 builtins";
  try {
    const std::string difference = difference_in(opened, *kernel);
    return difference.empty() ? "" : "the self-test fails at " + difference;
  } catch (const cl::Error& error) {
    return fmt::format("the self-test fails: {} gave {}", error.what(), code_name(error.err()));
  }
}

Simd probe_simd(const FoundDevice& found, const Opened& opened, const Builds& builds) {
  const std::string asked = asked_for();
  if (asked != "portable") {
    const std::string why_not = why_no_x86(found, opened, builds);
    if (why_not.empty()) return Simd::x86;
    if (asked == "x86")
      throw Error(ErrorCode::no_device,
                  fmt::format("KDRAY_SIMD=x86 can't be had on {}: {}; unset it", found.info.name, why_not));
  }
  check_portable(found, opened, builds);
  return Simd::portable;
}

Simd choose_simd(const FoundDevice& found, const Opened& opened, const Builds& builds) {
  static std::mutex mutex;
  static std::map<std::pair<int, std::string>, Simd> chosen;
  const std::lock_guard lock(mutex);
  const std::pair key{found.info.number, asked_for()};
  auto place = chosen.find(key);
  if (place == chosen.end()) place = chosen.emplace(key, probe_simd(found, opened, builds)).first;
  return place->second;
}

}  // namespace kdray::device
