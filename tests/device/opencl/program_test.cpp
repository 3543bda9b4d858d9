// Expansion of kernel sources, and what a failed build says.
#include "device/opencl/program.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "device/opencl/context.h"
#include "kernels.h"
#include "support/device.h"

namespace kdray::device {
namespace {

TEST(ExpandSource, LeavesNoIncludeOfOurs) {
  for (const kernels::Source& source : kernels::sources()) {
    const std::string text = expand_source(std::string(source.name));
    EXPECT_EQ(text.find("\n#include \""), std::string::npos) << source.name;
  }
}

TEST(ExpandSource, ReadsEachFileOnce) {
  const std::string text = expand_source("traverse/trace_closest.cl");
  const std::string mark = "#line 1 \"common/math.clh\"";
  const std::size_t first = text.find(mark);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(text.find(mark, first + 1), std::string::npos);
}

TEST(ExpandSource, RefusesAFileThatIsNotThere) {
  EXPECT_THROW((void)expand_source("no/such.cl"), Error);
}

class ProgramTest : public test::EachDevice {};

TEST_P(ProgramTest, AFailedBuildGivesOneLineWithThePlace) {
  const Context context(GetParam(), 1);
  try {
    (void)context.build_text("broken.cl",
                             "#include \"common/math.clh\"\n__kernel void f() { no_such_thing(); }\n",
                             "-cl-std=CL1.2");
    FAIL() << "no exception";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("broken.cl"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

KDRAY_FOR_EACH_DEVICE(ProgramTest);

}  // namespace
}  // namespace kdray::device
