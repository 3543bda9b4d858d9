// What    Which frame a page gets when; how large a frame is while the camera moves; when a file has changed.
#include <gtest/gtest.h>

#include "apps/view/frame_pacer.h"
#include "apps/view/scene_renderer.h"
#include "support/folder.h"

namespace kdray::view {
namespace {

Look look(std::uint32_t number, bool moving) {
  Look l;
  l.number = number;
  l.moving = moving;
  return l;
}

TEST(FramePacer, TheNewestLookWins) {
  FramePacer pacer;
  EXPECT_FALSE(pacer.next());
  pacer.request(look(1, true));
  pacer.request(look(2, true));
  ASSERT_EQ(pacer.next()->look.number, 2u);
  const FramePacer::Work work = *pacer.next();
  pacer.request(look(3, true));
  EXPECT_FALSE(pacer.is_current(work));
  pacer.finish(work, false);  // of an older one: the newer one still has work
  EXPECT_EQ(pacer.next()->look.number, 3u);
  pacer.finish(*pacer.next(), false);
  EXPECT_FALSE(pacer.next());
}

TEST(FramePacer, AtRestStepFollowsStep) {
  FramePacer pacer;
  pacer.request(look(1, false));
  for (std::size_t step = 0; step < 3; ++step) {
    ASSERT_EQ(pacer.next()->step, step);
    pacer.finish(*pacer.next(), step == 2);
  }
  EXPECT_FALSE(pacer.next());
  pacer.restart();
  EXPECT_EQ(pacer.next()->step, 0u);
}

TEST(FramePacer, AtMostTwoFramesAreInFlight) {
  FramePacer pacer;
  pacer.request(look(1, true));
  const std::uint32_t first = pacer.start_frame(), second = pacer.start_frame();
  EXPECT_FALSE(pacer.next()) << "two are not acknowledged";
  EXPECT_FALSE(pacer.acknowledge(99));
  EXPECT_TRUE(pacer.acknowledge(second));
  EXPECT_TRUE(pacer.next());
  EXPECT_FALSE(pacer.acknowledge(second)) << "once";
  EXPECT_TRUE(pacer.acknowledge(first));
}

TEST(ResolutionController, AFrameThatMovesKeepsToItsTime) {
  constexpr double kPixels = 1024 * 768;
  for (const double megapixel_seconds : {0.001, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0}) {
    ResolutionController controller;
    for (int i = 0; i < 20; ++i) {
      const int by = controller.divide_by(kPixels);
      controller.record(kPixels / (by * by), kPixels / (by * by) * megapixel_seconds / 1e6);
    }
    const int by = controller.divide_by(kPixels);
    const double seconds = kPixels / (by * by) * megapixel_seconds / 1e6;
    EXPECT_LE(seconds, kMovingSeconds) << megapixel_seconds;
    if (by > 1) {
      EXPECT_GT(4 * seconds, 0.5 * kMovingSeconds) << "smaller than need be: " << megapixel_seconds;
    }
  }
}

// A frame of a fourth of the pixels takes more than a fourth of the time: the picture at rest tells how much.
TEST(ResolutionController, APictureAtRestTellsWhatALargerFrameTakes) {
  constexpr double kPixels = 1024 * 768;
  struct Case {
    double fixed, full;  // seconds
    int by;
  };
  for (const Case& c :
       {Case{0.007, 0.09, 2}, Case{0.005, 0.035, 1}, Case{0.010, 0.4, 4}, Case{0.03, 0.9, 8}}) {
    const auto seconds = [&](double pixels) { return c.fixed + (c.full - c.fixed) * pixels / kPixels; };
    ResolutionController controller;
    controller.record(kPixels, seconds(kPixels));
    for (int i = 0; i < 6; ++i) {
      const int by = controller.divide_by(kPixels);
      controller.record(kPixels / (by * by), seconds(kPixels / (by * by)));
    }
    EXPECT_EQ(controller.divide_by(kPixels), c.by) << c.full;
  }
}

TEST(ResolutionController, RecoversFromAFrameThatWasInterrupted) {
  constexpr double kPixels = 1024 * 768;
  const auto seconds = [](double pixels) { return 0.007 + 0.08 * pixels / kPixels; };
  ResolutionController controller;
  controller.record(kPixels, 3.0);
  int frames = 0;
  for (; frames < 30 && controller.divide_by(kPixels) != 2; ++frames) {
    const int by = controller.divide_by(kPixels);
    controller.record(kPixels / (by * by), seconds(kPixels / (by * by)));
  }
  EXPECT_LT(frames, 15);
}

// A larger frame that turned out to be too slow is tried again, but seldom.
TEST(ResolutionController, LargerFramesAreTriedSeldom) {
  constexpr double kPixels = 1024 * 768;
  const auto seconds = [](int by) { return by >= 4 ? 0.012 : 0.09; };
  ResolutionController controller;
  int too_slow = 0;
  for (int i = 0; i < 400; ++i) {
    const int by = controller.divide_by(kPixels);
    too_slow += by < 4;
    controller.record(kPixels / (by * by), seconds(by));
  }
  EXPECT_LT(too_slow, 14);
}

TEST(Steps, EndWithThePictureThatIsWanted) {
  RenderOptions wanted;
  wanted.samples = 1;
  EXPECT_EQ(steps_to(wanted).size(), 1u);
  wanted.samples = 16;
  ASSERT_EQ(steps_to(wanted).size(), 2u);
  EXPECT_EQ(options_of(steps_to(wanted)[0], wanted).samples, 1);
  EXPECT_EQ(options_of(steps_to(wanted)[1], wanted).samples, 16);
  wanted.adaptive_target = 0.0075;
  const std::vector<Step> steps = steps_to(wanted);
  EXPECT_EQ(options_of(steps.front(), wanted).adaptive_target, 0);
  EXPECT_EQ(options_of(steps.back(), wanted).adaptive_target, 0.0075);
  EXPECT_TRUE(steps.back().last);
  wanted.channels = {"depth"};
  EXPECT_EQ(steps_to(wanted).size(), 1u);
}

TEST(FileWatcher, AChangeCountsOnceAndWhenItHasSettled) {
  const test::Folder folder;
  const std::string file = folder.put("a.nff", "one");
  FileWatcher watcher({file, folder / "not there"});
  EXPECT_FALSE(watcher.changed());
  folder.put("a.nff", "another");
  EXPECT_FALSE(watcher.changed()) << "it may still be being written";
  folder.put("a.nff", "another one");
  EXPECT_FALSE(watcher.changed());
  EXPECT_TRUE(watcher.changed());
  EXPECT_FALSE(watcher.changed());
  folder.put("not there", "now it is");
  watcher.changed();
  EXPECT_TRUE(watcher.changed());
}

}  // namespace
}  // namespace kdray::view
