// What    What PoCL is told by the environment, and the folders it may compile in.
// Shape   A program of its own, in which nothing has begun to use OpenCL yet.
#include "device/opencl/pocl_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <set>
#include <string>

#include "device/opencl/platform.h"
#include "support/folder.h"

namespace kdray::device {
namespace {

std::set<std::string> names_of_variables() {
  std::set<std::string> names;
  for (char** variable = ::environ; *variable; ++variable) {
    const std::string text = *variable;
    names.insert(text.substr(0, text.find('=')));
  }
  return names;
}

// Devices are opened by a thread of their own, and setenv() of a new name moves all variables while others
// read them.
TEST(PoclCache, AfterItNoLibraryAddsAVariable) {
  ASSERT_FALSE(names_of_variables().contains("HWLOC_PLUGINS_PATH"));
  pocl_cache();
  const std::set<std::string> before = names_of_variables();
  EXPECT_FALSE(find_devices().empty());
  EXPECT_EQ(names_of_variables(), before);
}

TEST(PoclCache, AFolderThatIsStillToBeMadeWillDo) {
  const test::Folder folder;
  EXPECT_EQ(why_no_cache(folder.path() / "a" / "b"), "");
  EXPECT_NE(why_no_cache("/proc/kdray"), "");
  EXPECT_NE(why_no_cache(""), "");
}

}  // namespace
}  // namespace kdray::device
