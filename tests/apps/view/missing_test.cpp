// What    A kdray without the page says what to install.
#include <gtest/gtest.h>

#include "apps/cli/view_args.h"

namespace kdray::cli {
namespace {

TEST(ViewMissing, SaysWhatToInstall) {
  ViewArgs args;
  try {
    show_page(args);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_NE(std::string(error.what()).find("libboost-dev"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("libturbojpeg0-dev"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace kdray::cli
