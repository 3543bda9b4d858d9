// What    The self-test on each device: rightly built kernels pass, wrong ones don't, and an outcome is
//         remembered only for the kernels that it is of.
#include "probe/selftest/self_test.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "device/opencl/program_cache.h"
#include "support/broken_kernels.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/folder.h"
#include "support/variable.h"

namespace kdray::selftest {
namespace {

class SelfTest : public test::EachDevice {
 protected:
  // The hit's distance is reported one float off.
  void break_kernels() const {
    test::put_kernels(broken_, "traverse/query.clh", "hit.t = scale_t(t, ",
                      "hit.t = scale_t(t * 1.0000002f, ");
  }
  device::Context context(const std::filesystem::path& folder = {}) const {
    device::Builds builds;
    if (!folder.empty()) builds.cache = std::make_shared<device::ProgramCache>(folder);
    return {GetParam(), 1, 0, builds};
  }

  test::Folder broken_;
};

TEST_P(SelfTest, ADeviceThatComputesRightlyPasses) {
  EXPECT_EQ(fault_of(context()), "");
  EXPECT_NO_THROW(require(context()));
}

TEST_P(SelfTest, ADeviceThatComputesWronglyIsNamed) {
  if (context().info().kind != "cpu") GTEST_SKIP() << "one bit is not enough on this device";
  break_kernels();
  const test::Variable kernels("KDRAY_KERNEL_DIR", broken_.path().string());
  EXPECT_NE(fault_of(context()).find("should hit primitive"), std::string::npos) << fault_of(context());
  EXPECT_TRUE(test::fails([&] { require(context()); }, context().info().name + " fails the self-test: ray",
                          ErrorCode::no_device));
}

TEST_P(SelfTest, ToldToFailItFailsThoughItHasPassed) {
  require(context());
  EXPECT_TRUE(test::fails([&] { require(context(), true); }, "fails the self-test", ErrorCode::no_device));
}

// The kernels are some that this process hasn't tested before: else there would be nothing to write.
TEST_P(SelfTest, TheOutcomeIsKeptAndItsProgramIsNot) {
  const std::filesystem::path folder = broken_ / "programs";
  (void)context();  // the vectors' test, which a process makes once and whose program is kept
  test::put_kernels(broken_, "traverse/query.cl", "__kernel void trace_query", "\n__kernel void trace_query");
  const test::Variable kernels("KDRAY_KERNEL_DIR", broken_.path().string());  // not tested before
  const device::Context cached = context(folder);
  require(cached);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  EXPECT_EQ(cached.builds().cache->keep(), 0u);
}

// Not a test: writes the table anew, after a change of the kernels that is meant to change bits. KnownCase
// then holds it against closed forms. --gtest_also_run_disabled_tests --gtest_filter='*WriteTheAnswers*/0'
TEST_P(SelfTest, DISABLED_WriteTheAnswers) {
  std::ofstream table(std::filesystem::path(KDRAY_SOURCE_DIR) / "host/probe/selftest/known_answers.inc");
  for (const Answer& a : answers_of(context()))
    table << fmt::format("{{{:#010x}u, {}, {:#010x}u, {:#010x}u}},\n", a.t, a.primitive, a.u, a.v);
  EXPECT_TRUE(table.flush());
}

KDRAY_FOR_EACH_DEVICE(SelfTest);

}  // namespace
}  // namespace kdray::selftest
