// What    The table of settings: complete, without doubles, and merged as it should be.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "device/tuning/settings.h"

namespace kdray::test {
namespace {

TEST(Settings, TheTableNamesEveryMemberOfTuningOnce) {
  Tuning all;
  std::set<std::string_view> names;
  for (const tuning::Setting& s : tuning::settings()) {
    EXPECT_TRUE(names.insert(s.name).second) << s.name;
    EXPECT_EQ(all.*s.value, 0) << s.name;
    all.*s.value = s.values.front();
    EXPECT_TRUE(s.slices || s.global) << s.name;
    EXPECT_TRUE(std::ranges::all_of(s.values, [](int v) { return v > 0; })) << "0 is kdray's own choice";
  }
  EXPECT_EQ(names.size() * sizeof(int), sizeof(Tuning)) << "a member without a row is never tuned";
}

TEST(Settings, AreFoundByName) {
  EXPECT_EQ(tuning::find_setting("packets")->value, &Tuning::packets);
  EXPECT_EQ(tuning::find_setting("colour"), nullptr);
}

TEST(Settings, MergedTakesWhatIsSet) {
  const Tuning both = tuning::merged({.tile = 16, .batch = 256}, {.batch = 1024, .waves = 32});
  EXPECT_EQ(both, (Tuning{.tile = 16, .batch = 1024, .waves = 32}));
}

TEST(Settings, WordsNameWhatIsSet) {
  EXPECT_EQ(tuning::in_words({}), "kdray's own");
  EXPECT_EQ(tuning::in_words({.batch = 1024, .packets = 4}), "batch 1024, packets 4");
}

TEST(Settings, EveryKindOfDeviceHasDefaultsOfTheTable) {
  for (const char* const kind : {"cpu", "gpu", "accelerator", "unheard of"}) {
    const Tuning tuning = tuning::shipped(kind);
    for (const tuning::Setting& s : tuning::settings())
      EXPECT_TRUE(tuning.*s.value == 0 || std::ranges::count(s.values, tuning.*s.value) == 1)
          << kind << " " << s.name;
  }
}

}  // namespace
}  // namespace kdray::test
