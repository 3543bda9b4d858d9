#include "device/opencl/simd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "device/opencl/context.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/program.h"

namespace kdray::device {

namespace {

using SimdTest = kernels::SimdTest;

std::string options_for(Simd form) {
  return "-cl-std=CL1.2 " + build_option(form);
}

// A form that needs more than OpenCL C: its name in KDRAY_SIMD and in words, and what the processor must
// have.
struct Form {
  Simd form;
  const char* asked;
  const char* words;
  bool (*processor_has)();
  const char* needs;
};

bool has_avx2() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

bool has_avx512() {
#if defined(__x86_64__) && defined(__GNUC__)
  return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
#else
  return false;
#endif
}

// From the best on; every device must pass the last.
constexpr Form kForms[] = {
    {Simd::avx512, "avx512", "x86 AVX-512", has_avx512, "AVX-512 (F, VL, DQ and BW)"},
    {Simd::avx2, "avx2", "x86 AVX2", has_avx2, "AVX2 and FMA"},
    {Simd::portable, "portable", "portable", nullptr, nullptr},
};

const Form& described(Simd form) {
  return *std::ranges::find(kForms, form, &Form::form);
}

// Returns the form's kernel, or none where the compiler refuses it: that is an answer, not an error, so
// nothing reports it.
std::optional<Kernel<SimdTest>> try_probe_build(Simd form, const OpenDevice& opened, const Builds& builds) {
  try {
    std::string log;
    const cl::Program program = try_build(opened.context, opened.devices, expand_source(SimdTest::kFile),
                                          options_for(form), builds, log);
    if (program() != nullptr) return Kernel<SimdTest>(program);
  } catch (const cl::Error&) {  // refused in another way
  } catch (const Error&) {
  }
  return std::nullopt;
}

std::string difference_in(const OpenDevice& opened, Kernel<SimdTest>& kernel) {
  const std::vector<layout::SimdCase> cases = known_cases();
  return first_difference(cases, run_simd_test(opened, kernel, cases));
}

// Returns the form that KDRAY_SIMD asks for; null: the best.
const Form* asked_for() {
  const char* value = std::getenv("KDRAY_SIMD");
  const std::string_view asked = value == nullptr ? "" : value;
  if (asked.empty()) return nullptr;
  for (const Form& form : kForms)
    if (asked == form.asked) return &form;
  throw Error(ErrorCode::usage,
              fmt::format("KDRAY_SIMD is '{}'; it may be portable, avx2 or avx512, or unset", asked));
}

void check_portable(const FoundDevice& found, const OpenDevice& opened, const Builds& builds) {
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
  return described(form).words;
}

std::string build_option(Simd form) {
  return fmt::format("-DKDRAY_SIMD={}", static_cast<int>(form));
}

std::string SimdChoice::refused_in_words() const {
  std::string text;
  for (const Refusal& refusal : refused)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", in_words(refusal.form), refusal.why);
  return text;
}

std::vector<layout::SimdAnswers> run_simd_test(const OpenDevice& opened, Kernel<SimdTest>& kernel,
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

// The checks come in this order because each makes the next one safe: code with instructions that the
// processor lacks may well build (a compiler can be told any target) and then kills the process, which no
// self-test survives. The processor that is checked is the one this runs on, which is a CPU device's own; the
// compiler of a GPU or an accelerator need not be tried with builtins that aren't its own.
std::string why_not(Simd form, const FoundDevice& found, const OpenDevice& opened, const Builds& builds) {
  const Form& wanted = described(form);
  if (!wanted.processor_has) return "";
  if (!wanted.processor_has()) return fmt::format("the processor has no {}", wanted.needs);
  if (found.info.kind != "cpu") return "the device is not a CPU";
  std::optional<Kernel<SimdTest>> kernel = try_probe_build(form, opened, builds);
  if (!kernel) return fmt::format("the device's compiler refuses the {} builtins", wanted.words);
  try {
    const std::string difference = difference_in(opened, *kernel);
    return difference.empty() ? "" : "the self-test fails at " + difference;
  } catch (const cl::Error& error) {
    return fmt::format("the self-test fails: {} gave {}", error.what(), code_name(error.err()));
  }
}

SimdChoice probe_simd(const FoundDevice& found, const OpenDevice& opened, const Builds& builds) {
  const Form* const asked = asked_for();
  SimdChoice choice;
  for (const Form& form : kForms) {
    if (asked && asked != &form) continue;
    choice.form = form.form;
    if (form.form == Simd::portable) break;
    const std::string why = why_not(form.form, found, opened, builds);
    if (why.empty()) return choice;
    if (asked)
      throw Error(ErrorCode::no_device, fmt::format("KDRAY_SIMD={} can't be had on {}: {}; unset it",
                                                    form.asked, found.info.name, why));
    choice.refused.push_back({form.form, why});
  }
  check_portable(found, opened, builds);
  return choice;
}

SimdChoice choose_simd(const FoundDevice& found, const OpenDevice& opened, const Builds& builds) {
  static std::mutex mutex;
  static std::map<std::pair<int, const Form*>, SimdChoice> chosen;
  const std::lock_guard lock(mutex);
  const std::pair key{found.info.number, asked_for()};
  auto place = chosen.find(key);
  if (place == chosen.end()) place = chosen.emplace(key, probe_simd(found, opened, builds)).first;
  return place->second;
}

}  // namespace kdray::device
