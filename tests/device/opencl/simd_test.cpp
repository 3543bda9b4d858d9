// The choice of the vectors' form: what each device gets, what the environment asks for, and that a compiler
// that refuses or miscomputes the builtins costs that form, not the run. Broken compilers are played by
// broken kernel sources.
#include "device/opencl/simd.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "device/opencl/context.h"
#include "support/broken_kernels.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/folder.h"
#include "support/variable.h"

namespace kdray::device {
namespace {

using test::put_kernels;
using test::Variable;

class SimdTest : public test::EachDevice {
 protected:
  const Variable nothing_asked_for_{"KDRAY_SIMD"};
  FoundDevice found_ = choose_device(GetParam());
  const Context context_{GetParam(), 1};
  const OpenDevice& opened_ = context_.opened();

  bool works(Simd form) const { return why_not(form, found_, opened_).empty(); }

  Simd best() const {
    for (const Simd form : {Simd::avx512, Simd::avx2})
      if (works(form)) return form;
    return Simd::portable;
  }
};

TEST_P(SimdTest, TheContextHasTheBestFormThatPasses) {
  const Context context(GetParam(), 1);
  EXPECT_EQ(context.simd(), best());
  EXPECT_EQ(context.info().vectors, in_words(context.simd()));
  EXPECT_EQ(context.info().vectors_refused.empty(), best() == Simd::avx512) << context.info().vectors_refused;
}

TEST_P(SimdTest, TheEnvironmentAsksForTheFormAndOtherContextsAreNotBoundByIt) {
  const std::pair<const char*, Simd> forms[] = {
      {"portable", Simd::portable}, {"avx2", Simd::avx2}, {"avx512", Simd::avx512}};
  for (const auto& [name, form] : forms) {
    const Variable asked("KDRAY_SIMD", name);
    if (works(form))
      EXPECT_EQ(Context(GetParam(), 1).simd(), form);
    else
      EXPECT_TRUE(test::fails([&] { (void)Context(GetParam(), 1); }, std::string("KDRAY_SIMD=") + name,
                              ErrorCode::no_device));
  }
  EXPECT_EQ(Context(GetParam(), 1).simd(), best());
}

TEST_P(SimdTest, AnUnknownFormIsAUsageError) {
  const Variable asked("KDRAY_SIMD", "neon");
  EXPECT_TRUE(test::fails([&] { (void)Context(GetParam(), 1); }, "'neon'", ErrorCode::usage));
}

// How each form is broken: what its compiler must know of itself, a builtin, and a comparison that is true
// for NaN.
struct Broken {
  Simd form;
  const char *asked, *file, *target, *builtin, *right, *wrong;
};
constexpr Broken kBroken[] = {
    {Simd::avx512, "avx512", "common/simd_avx512.clh", "defined(__AVX512F__)", "__builtin_ia32_cmpps512_mask",
     "#define KDRAY_CMP_LT 17\n", "#define KDRAY_CMP_LT 25\n"},
    {Simd::avx2, "avx2", "common/simd_avx2.clh", "defined(__AVX2__)", "__builtin_ia32_movmskps256",
     "mask_of16(a.lo < b.lo,", "mask_of16(~(a.lo >= b.lo),"},
};

class BrokenFormTest : public SimdTest {
 protected:
  // The next form that the device has below this one.
  Simd next_below(Simd form) const {
    return form == Simd::avx512 && works(Simd::avx2) ? Simd::avx2 : Simd::portable;
  }
  bool is_chosen_first(const Broken& broken) const { return broken.form == best(); }
};

TEST_P(BrokenFormTest, ACompilerWithoutTheInstructionsMeansTheNextFormAndNothingIsPrinted) {
  if (best() == Simd::portable) GTEST_SKIP() << why_not(Simd::avx2, found_, opened_);
  for (const Broken& broken : kBroken) {
    if (!is_chosen_first(broken)) continue;
    const test::Folder folder;
    put_kernels(folder, "common/simd_test.cl", broken.target, "defined(NO_SUCH_TARGET)");
    const Variable kernels("KDRAY_KERNEL_DIR", folder.path().string());
    testing::internal::CaptureStderr();
    const SimdChoice choice = probe_simd(found_, opened_);
    EXPECT_EQ(choice.form, next_below(broken.form));
    EXPECT_NE(choice.refused_in_words().find("refuses"), std::string::npos) << choice.refused_in_words();
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

TEST_P(BrokenFormTest, ARefusedProbeBuildMeansTheNextFormAndLeavesNothingBehind) {
  if (best() == Simd::portable) GTEST_SKIP() << why_not(Simd::avx2, found_, opened_);
  for (const Broken& broken : kBroken) {
    if (!works(broken.form)) continue;
    const test::Folder folder;
    std::filesystem::create_directories(folder / "tmp");
    put_kernels(folder, broken.file, broken.builtin, "__builtin_no_such_thing");
    const Variable kernels("KDRAY_KERNEL_DIR", folder.path().string());
    const Variable temporary("TMPDIR",
                             (folder / "tmp").string());  // where a failed build's source and log go
    EXPECT_EQ(probe_simd(found_, opened_).form, is_chosen_first(broken) ? next_below(broken.form) : best());
    EXPECT_FALSE(std::filesystem::exists(folder / "tmp/kdray_failed_common_simd_test.cl"));
    const Variable asked("KDRAY_SIMD", broken.asked);
    EXPECT_TRUE(test::fails([&] { (void)probe_simd(found_, opened_); }, "refuses", ErrorCode::no_device));
  }
}

TEST_P(BrokenFormTest, AWrongAnswerMeansTheNextForm) {
  if (best() == Simd::portable) GTEST_SKIP() << why_not(Simd::avx2, found_, opened_);
  for (const Broken& broken : kBroken) {
    if (!works(broken.form)) continue;
    const test::Folder folder;
    put_kernels(folder, broken.file, broken.right, broken.wrong);
    const Variable kernels("KDRAY_KERNEL_DIR", folder.path().string());
    EXPECT_EQ(probe_simd(found_, opened_).form, is_chosen_first(broken) ? next_below(broken.form) : best());
    EXPECT_EQ(why_not(broken.form, found_, opened_), "the self-test fails at less16 of case 0");
    const Variable asked("KDRAY_SIMD", broken.asked);
    EXPECT_TRUE(test::fails([&] { (void)probe_simd(found_, opened_); }, "less16", ErrorCode::no_device));
  }
}

KDRAY_FOR_EACH_DEVICE(BrokenFormTest);

TEST_P(SimdTest, ADeviceThatFailsThePortableFormIsNoDevice) {
  const test::Folder folder;
  put_kernels(folder, "common/simd_portable.clh", "mask_of16(a <= b)", "mask_of16(a < b)");
  const Variable kernels("KDRAY_KERNEL_DIR", folder.path().string());
  const Variable asked("KDRAY_SIMD", "portable");
  EXPECT_TRUE(test::fails([&] { (void)probe_simd(found_, opened_); },
                          found_.info.name + " computes wrongly: less_equal16", ErrorCode::no_device));
}

KDRAY_FOR_EACH_DEVICE(SimdTest);

// The self-test tells forms apart by bits: any changed word of any answer must be seen.
TEST(SimdAnswers, EveryWordOfEveryAnswerIsCompared) {
  const std::vector<layout::SimdCase> cases = known_cases();
  std::vector<layout::SimdAnswers> answers;
  for (const layout::SimdCase& c : cases) answers.push_back(expected_answers(c));
  EXPECT_EQ(first_difference(cases, answers), "");
  layout::SimdAnswers& last = answers.back();
  constexpr std::size_t kWords = sizeof(last) / sizeof(layout::u32);
  constexpr std::size_t kPad = offsetof(layout::SimdAnswers, pad) / sizeof(layout::u32);
  auto* words = reinterpret_cast<layout::u32*>(&last);
  for (std::size_t i = 0; i < kWords; ++i) {
    words[i] ^= 1u;
    EXPECT_EQ(first_difference(cases, answers).empty(), i == kPad) << "word " << i;
    words[i] ^= 1u;
  }
}

TEST(SimdAnswers, TheKnownCasesHaveEveryMaskOfEightAndEveryPairInEveryLane) {
  std::set<std::uint32_t> low, high;
  for (const layout::SimdCase& c : known_cases()) low.insert(c.mask & 255u), high.insert(c.mask >> 8);
  EXPECT_EQ(low.size(), 256u);
  EXPECT_EQ(high.size(), 256u);
  for (int lane = 0; lane < 16; ++lane) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const layout::SimdCase& c : known_cases()) pairs.insert({c.a[lane], c.b[lane]});
    EXPECT_EQ(pairs.size(), 256u) << lane;
  }
}

}  // namespace
}  // namespace kdray::device
