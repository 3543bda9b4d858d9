// What    The notice of compiling: only when it takes long, once, and cleared. No test waits for real seconds
//         to be right: patience is either none or endless.
#include "apps/cli/progress.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace kdray::cli {
namespace {

struct Heard {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::string> lines;

  void hear(const std::string& line) {
    const std::lock_guard lock(mutex);
    lines.push_back(line);
    changed.notify_all();
  }
  // Waits until something was heard, but not for ever.
  std::string first() {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::seconds(60), [&] { return !lines.empty(); });
    return lines.empty() ? "" : lines.front();
  }
};

TEST(BuildNotice, SaysNothingOfShortWork) {
  Heard heard;
  {
    BuildNotice notice({[&](const std::string& line) { heard.hear(line); }, {}}, 1e9);
    notice.tell(true);
    notice.tell(false);
  }
  EXPECT_TRUE(heard.lines.empty());
}

TEST(BuildNotice, SaysItOnceWhenItTakesLong) {
  Heard heard;
  {
    BuildNotice notice({[&](const std::string& line) { heard.hear(line); }, {}}, 0);
    notice.tell(true);
    notice.tell(true);
    EXPECT_NE(heard.first().find("compiling kernels"), std::string::npos);
    notice.tell(false);
    notice.tell(false);
    notice.tell(true);
    notice.tell(false);
  }
  EXPECT_EQ(heard.lines.size(), 1u);
}

TEST(BuildNotice, ADrawnLineIsClearedAtTheEnd) {
  Heard heard;
  {
    BuildNotice notice({{}, [&](const std::string& line) { heard.hear(line); }}, 0);
    notice.tell(true);
    EXPECT_NE(heard.first().find("compiling kernels"), std::string::npos);
    notice.tell(false);
  }
  EXPECT_EQ(heard.lines.back(), "");
}

TEST(BuildNotice, NothingOfWorkThatHasNotBegunOrWasMuted) {
  Heard heard;
  {
    BuildNotice notice({[&](const std::string& line) { heard.hear(line); }, {}}, 0);
    notice.mute();
    notice.tell(true);
    notice.tell(false);
  }
  EXPECT_TRUE(heard.lines.empty());
}

}  // namespace
}  // namespace kdray::cli
