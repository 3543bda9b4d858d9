// The choice of the vectors' form: what each device gets, what the environment asks for, and that a compiler
// that refuses or miscomputes the builtins costs the x86 form, not the run. Broken compilers are played by
// broken kernel sources.
#include "device/simd.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "device/context.h"
#include "device/simd_answers.h"
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
  const Opened& opened_ = Context(GetParam(), 1).opened();  // open until the process ends

  bool x86_works() const { return why_no_x86(found_, opened_).empty(); }
};

TEST_P(SimdTest, TheContextHasTheFormThatPasses) {
  const Context context(GetParam(), 1);
  EXPECT_EQ(context.simd(), x86_works() ? Simd::x86 : Simd::portable);
  EXPECT_EQ(context.info().vectors, in_words(context.simd()));
}

TEST_P(SimdTest, TheEnvironmentAsksForTheFormAndOtherContextsAreNotBoundByIt) {
  {
    const Variable asked("KDRAY_SIMD", "portable");
    EXPECT_EQ(Context(GetParam(), 1).simd(), Simd::portable);
  }
  EXPECT_EQ(Context(GetParam(), 1).simd(), x86_works() ? Simd::x86 : Simd::portable);
  const Variable asked("KDRAY_SIMD", "x86");
  if (x86_works())
    EXPECT_EQ(Context(GetParam(), 1).simd(), Simd::x86);
  else
    EXPECT_TRUE(test::fails([&] { (void)Context(GetParam(), 1); }, "KDRAY_SIMD=x86", ErrorCode::no_device));
}

TEST_P(SimdTest, AnUnknownFormIsAUsageError) {
  const Variable asked("KDRAY_SIMD", "neon");
  EXPECT_TRUE(test::fails([&] { (void)Context(GetParam(), 1); }, "'neon'", ErrorCode::usage));
}

TEST_P(SimdTest, ACompilerWithoutAvx512MeansPortableAndNothingIsPrinted) {
  if (!x86_works()) GTEST_SKIP() << why_no_x86(found_, opened_);
  const test::Folder folder;
  put_kernels(folder, "common/simd_test.cl", "defined(__AVX512F__)", "defined(NO_SUCH_TARGET)");
  const Variable kernels("KDRAY_KERNEL_DIR", folder.path().string());
  testing::internal::CaptureStderr();
  EXPECT_EQ(probe_simd(found_, opened_), Simd::portable);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_P(SimdTest, ARefusedProbeBuildMeansPortableAndLeavesNothingBehind) {
  if (!x86_works()) GTEST_SKIP() << why_no_x86(found_, opened_);
  const test::Folder folder;
  std::filesystem::create_directories(folder / "tmp");
  put_kernels(folder, "common/simd.clh", "__builtin_ia32_cmpps512_mask", "__builtin_no_such_thing");
  const Variable kernels("KDRAY_KERNEL_DIR", folder.path().string());
  const Variable temporary("TMPDIR", (folder / "tmp").string());  // where source and log of a failed build go
  EXPECT_EQ(probe_simd(found_, opened_), Simd::portable);
  EXPECT_FALSE(std::filesystem::exists(folder / "tmp/kdray_failed_common_simd_test.cl"));
  const Variable asked("KDRAY_SIMD", "x86");
  EXPECT_TRUE(test::fails([&] { (void)probe_simd(found_, opened_); }, "refuses", ErrorCode::no_device));
}

TEST_P(SimdTest, AWrongAnswerMeansPortable) {
  if (!x86_works()) GTEST_SKIP() << why_no_x86(found_, opened_);
  const test::Folder folder;
  // Not less-or-equal: true for NaN.
  put_kernels(folder, "common/simd.clh", "#define KDRAY_CMP_LT 17\n", "#define KDRAY_CMP_LT 25\n");
  const Variable kernels("KDRAY_KERNEL_DIR", folder.path().string());
  EXPECT_EQ(probe_simd(found_, opened_), Simd::portable);
  EXPECT_EQ(why_no_x86(found_, opened_), "the self-test fails at less16 of case 0");
  const Variable asked("KDRAY_SIMD", "x86");
  EXPECT_TRUE(test::fails([&] { (void)probe_simd(found_, opened_); }, "less16", ErrorCode::no_device));
}

TEST_P(SimdTest, ADeviceThatFailsThePortableFormIsNoDevice) {
  const test::Folder folder;
  put_kernels(folder, "common/simd.clh", "mask_of16(a <= b)", "mask_of16(a < b)");
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
