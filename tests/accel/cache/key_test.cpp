#include "accel/cache/cache.h"

#include <gtest/gtest.h>

#include <set>

namespace kdray::cache {
namespace {

TEST(Key, ChangesWithAllThatShapesTheScene) {
  const Hash content{1, 2};
  const std::set<std::string> keys = {
      in_hex(key_of("a.ply", content, {}, {})),
      in_hex(key_of("a.obj", content, {}, {})),
      in_hex(key_of("a.ply.gz", content, {}, {})),
      in_hex(key_of("a.ply.xz", content, {}, {})),
      in_hex(key_of("a.ply", {1, 3}, {}, {})),
      in_hex(key_of("a.ply", {2, 2}, {}, {})),
      in_hex(key_of("a.ply", content, {.quality = BuildQuality::fast}, {})),
      in_hex(key_of("a.ply", content, {.quality = BuildQuality::best}, {})),
      in_hex(key_of("a.ply", content, {.max_depth = 12}, {})),
      in_hex(key_of("a.ply", content, {.cost_traverse = 1.0 + 1e-16 * 3}, {})),
      in_hex(key_of("a.ply", content, {.cost_intersect = 3}, {})),
      in_hex(key_of("a.ply", content, {.memory_bytes = 1}, {})),
      in_hex(key_of("a.ply", content, {.binary_form = false}, {})),
      in_hex(key_of("a.ply", content, {}, {.smooth_degrees = 0})),
      in_hex(key_of("a.ply", content, {}, {.smooth_degrees = 30})),
      in_hex(key_of("a.ply", content, {}, {.asset_root = "a"})),
  };
  EXPECT_EQ(keys.size(), 16u);
}

TEST(Key, IsThatOfTheContentWhereverItLies) {
  EXPECT_EQ(key_of("here/a.ply", {1, 2}, {}, {}), key_of("/there/b.ply", {1, 2}, {}, {}));
}

}  // namespace
}  // namespace kdray::cache
