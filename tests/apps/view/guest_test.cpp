// What    What a page is owed, when; and how large a frame is while the camera moves.
#include <gtest/gtest.h>

#include "apps/view/guest.h"
#include "apps/view/ladder.h"
#include "apps/view/watch.h"
#include "support/folder.h"

namespace kdray::view {
namespace {

Look look(std::uint32_t number, bool moving) {
  Look l;
  l.number = number;
  l.moving = moving;
  return l;
}

TEST(Guest, TheNewestLookWins) {
  Guest guest;
  EXPECT_FALSE(guest.next());
  guest.ask(look(1, true));
  guest.ask(look(2, true));
  ASSERT_EQ(guest.next()->look.number, 2u);
  const Guest::Work work = *guest.next();
  guest.ask(look(3, true));
  EXPECT_FALSE(guest.wants(work));
  guest.done(work, false);  // of an older one: the newer one is still owed
  EXPECT_EQ(guest.next()->look.number, 3u);
  guest.done(*guest.next(), false);
  EXPECT_FALSE(guest.next());
}

TEST(Guest, AtRestStepFollowsStep) {
  Guest guest;
  guest.ask(look(1, false));
  for (std::size_t step = 0; step < 3; ++step) {
    ASSERT_EQ(guest.next()->step, step);
    guest.done(*guest.next(), step == 2);
  }
  EXPECT_FALSE(guest.next());
  guest.begin_anew();
  EXPECT_EQ(guest.next()->step, 0u);
}

TEST(Guest, AtMostTwoFramesAreOnTheWay) {
  Guest guest;
  guest.ask(look(1, true));
  const std::uint32_t first = guest.send(), second = guest.send();
  EXPECT_FALSE(guest.next()) << "it doesn't take them";
  EXPECT_FALSE(guest.shown(99));
  EXPECT_TRUE(guest.shown(second));
  EXPECT_TRUE(guest.next());
  EXPECT_FALSE(guest.shown(second)) << "once";
  EXPECT_TRUE(guest.shown(first));
}

TEST(Ladder, AFrameThatMovesKeepsToItsTime) {
  constexpr double kPixels = 1024 * 768;
  for (const double megapixel_seconds : {0.001, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0}) {
    Ladder ladder;
    for (int i = 0; i < 20; ++i) {
      const int by = ladder.divide_by(kPixels);
      ladder.took(kPixels / (by * by), kPixels / (by * by) * megapixel_seconds / 1e6);
    }
    const int by = ladder.divide_by(kPixels);
    const double seconds = kPixels / (by * by) * megapixel_seconds / 1e6;
    EXPECT_LE(seconds, kMovingSeconds) << megapixel_seconds;
    if (by > 1) {
      EXPECT_GT(4 * seconds, 0.5 * kMovingSeconds) << "smaller than need be: " << megapixel_seconds;
    }
  }
}

// A frame of a fourth of the pixels takes more than a fourth of the time: the picture at rest tells how much.
TEST(Ladder, APictureAtRestTellsWhatALargerFrameTakes) {
  constexpr double kPixels = 1024 * 768;
  struct Case {
    double fixed, full;  // seconds
    int by;
  };
  for (const Case& c :
       {Case{0.007, 0.09, 2}, Case{0.005, 0.035, 1}, Case{0.010, 0.4, 4}, Case{0.03, 0.9, 8}}) {
    const auto seconds = [&](double pixels) { return c.fixed + (c.full - c.fixed) * pixels / kPixels; };
    Ladder ladder;
    ladder.took(kPixels, seconds(kPixels));
    for (int i = 0; i < 6; ++i) {
      const int by = ladder.divide_by(kPixels);
      ladder.took(kPixels / (by * by), seconds(kPixels / (by * by)));
    }
    EXPECT_EQ(ladder.divide_by(kPixels), c.by) << c.full;
  }
}

TEST(Ladder, RecoversFromAFrameThatWasInterrupted) {
  constexpr double kPixels = 1024 * 768;
  const auto seconds = [](double pixels) { return 0.007 + 0.08 * pixels / kPixels; };
  Ladder ladder;
  ladder.took(kPixels, 3.0);
  int frames = 0;
  for (; frames < 30 && ladder.divide_by(kPixels) != 2; ++frames) {
    const int by = ladder.divide_by(kPixels);
    ladder.took(kPixels / (by * by), seconds(kPixels / (by * by)));
  }
  EXPECT_LT(frames, 15);
}

// A larger frame that turned out to be too slow is tried again, but seldom.
TEST(Ladder, LargerFramesAreTriedSeldom) {
  constexpr double kPixels = 1024 * 768;
  const auto seconds = [](int by) { return by >= 4 ? 0.012 : 0.09; };
  Ladder ladder;
  int too_slow = 0;
  for (int i = 0; i < 400; ++i) {
    const int by = ladder.divide_by(kPixels);
    too_slow += by < 4;
    ladder.took(kPixels / (by * by), seconds(by));
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

TEST(Watch, AChangeCountsOnceAndWhenItHasSettled) {
  const test::Folder folder;
  const std::string file = folder.put("a.nff", "one");
  Watch watch({file, folder / "not there"});
  EXPECT_FALSE(watch.changed());
  folder.put("a.nff", "another");
  EXPECT_FALSE(watch.changed()) << "it may still be being written";
  folder.put("a.nff", "another one");
  EXPECT_FALSE(watch.changed());
  EXPECT_TRUE(watch.changed());
  EXPECT_FALSE(watch.changed());
  folder.put("not there", "now it is");
  watch.changed();
  EXPECT_TRUE(watch.changed());
}

}  // namespace
}  // namespace kdray::view
