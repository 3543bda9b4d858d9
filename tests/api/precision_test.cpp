// What double can't do is told in one line, with the code that fits: the device's fault is another than the
// user's.
#include "api/precision.h"

#include <gtest/gtest.h>

#include "support/errors.h"

namespace kdray::test {
namespace {

DeviceInfo device(bool double_precision) {
  DeviceInfo info;
  info.name = "Some GPU";
  info.double_precision = double_precision;
  return info;
}

TEST(Precision, FloatTakesAnyWalkOnAnyDevice) {
  for (const Traversal t :
       {Traversal::automatic, Traversal::binary, Traversal::wide, Traversal::packet, Traversal::batch})
    EXPECT_EQ(api::traversal_in(Precision::float32, t, device(false)), t);
}

TEST(Precision, DoubleTakesTheBinaryWalkWhereTheDeviceHasIt) {
  for (const Traversal t : {Traversal::automatic, Traversal::binary}) {
    EXPECT_EQ(api::traversal_in(Precision::float64, t, device(true)), Traversal::binary);
    EXPECT_TRUE(fails([&] { (void)api::traversal_in(Precision::float64, t, device(false)); },
                      "Some GPU does not compute in double", ErrorCode::no_device));
  }
  for (const Traversal t : {Traversal::wide, Traversal::packet, Traversal::batch})
    EXPECT_TRUE(fails([&] { (void)api::traversal_in(Precision::float64, t, device(true)); }, "binary",
                      ErrorCode::usage));
}

TEST(Precision, TheBinaryFormIsForTheBinaryWalkDoubleAndChannels) {
  const auto taken = [](Traversal t, Precision p, const std::vector<std::string>& channels) {
    return takes_binary_form(t, p, channels);
  };
  for (const Traversal t : {Traversal::automatic, Traversal::wide, Traversal::packet, Traversal::batch}) {
    EXPECT_FALSE(taken(t, Precision::float32, {}));
    EXPECT_FALSE(taken(t, Precision::float32, {"samples"}));
    EXPECT_TRUE(taken(t, Precision::float32, {"samples", "depth"}));
    EXPECT_TRUE(taken(t, Precision::float64, {}));
  }
  EXPECT_TRUE(taken(Traversal::binary, Precision::float32, {}));
}

}  // namespace
}  // namespace kdray::test
