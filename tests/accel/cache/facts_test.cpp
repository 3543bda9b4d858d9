#include "accel/cache/entry.h"

#include <gtest/gtest.h>

#include <limits>

namespace kdray::cache {
namespace {

prepare::Prepared with_everything() {
  prepare::Prepared p;
  p.settings.name = "a/\xff\xfe name.obj";  // file names need not be UTF-8
  p.settings.warnings = {"one", "two: \"2\"\n"};
  p.settings.names = std::make_shared<const scene::Names>(
      scene::Names{"a \xc3\xbc", {0, 4}, {0, 1}, {{0, 1}, {7, 0}}, {{2, 1}, {3, 0}}});
  p.settings.files = {{"a/b.obj", Hash{~std::uint64_t{0}, 1}},
                      {"c.mtl", std::nullopt},
                      {.path = "d.png", .content = std::nullopt, .only_named = true}};
  p.settings.camera = scene::Camera{{0.1, 1e300, -0.0}, {1, 2, 3}, {0, 0, 1}, 0.7, 1e-308};
  p.settings.cameras = {*p.settings.camera, scene::Camera{.ortho_width = 0.3, .aperture = 0.2, .focus = 7}};
  p.settings.sky = {.kind = scene::SkyKind::picture, .brightest = 1e4};
  p.settings.framing = {true, true, {dvec3(-0.1), dvec3(1.0 / 3)}};
  p.settings.background = vec3(0.1f, 1e-40f, 3e38f);
  p.settings.settings.width = 640;
  p.settings.settings.min_weight = 0.1;
  p.geometry.space = {{1.0 / 3, 1e6 + 0.1, -7}, 0x1p-900};
  p.geometry.bounds = {vec3(-1.1f), vec3(2.2f)};
  p.geometry.dropped_degenerate = 3;
  p.counts = {10, 5, 2, 1, 0, 4};
  p.features = 0xdeadbeef;
  p.tree_depth = 33;
  p.tree_nodes = std::uint64_t{1} << 40;
  p.tree.leaves_by_size = {1, 2, 3};
  p.tree.sah_cost = 1.0 / 7;
  p.tree.max_depth = 31;
  p.wide.block = 4;
  p.wide.stack_size = 99;
  return p;
}

TEST(Facts, ComeBackBitForBit) {
  const std::string bytes = to_bytes(with_everything());
  prepare::Prepared back;
  from_bytes(bytes, back);
  EXPECT_EQ(to_bytes(back), bytes);
  EXPECT_EQ(back.settings.name, "a/\xff\xfe name.obj");
  EXPECT_EQ(back.settings.files, with_everything().settings.files);
  ASSERT_TRUE(back.settings.names);
  EXPECT_EQ(*back.settings.names, *with_everything().settings.names);
  EXPECT_EQ(back.settings.camera->from.y, 1e300);
  EXPECT_TRUE(std::signbit(back.settings.camera->from.z));
  ASSERT_EQ(back.settings.cameras.size(), 2u);
  EXPECT_EQ(back.settings.cameras[1].ortho_width, 0.3);
  EXPECT_EQ(back.settings.cameras[1].aperture, 0.2);
  EXPECT_EQ(back.settings.cameras[1].focus, 7);
  EXPECT_EQ(back.settings.sky.kind, scene::SkyKind::picture);
  EXPECT_EQ(back.settings.sky.brightest, 1e4);
  EXPECT_TRUE(back.settings.framing.lights);
  EXPECT_EQ(back.settings.framing.box.hi.z, 1.0 / 3);
  EXPECT_EQ(back.settings.background.y, 1e-40f);
  EXPECT_EQ(back.settings.settings.width, 640);
  EXPECT_FALSE(back.settings.settings.height);
  EXPECT_EQ(back.geometry.space, with_everything().geometry.space);
  EXPECT_EQ(back.tree.sah_cost, 1.0 / 7);
}

// An empty scene's bounds.
TEST(Facts, InfinitiesComeBack) {
  prepare::Prepared p, back;
  from_bytes(to_bytes(p), back);
  EXPECT_EQ(back.geometry.bounds.lo.x, std::numeric_limits<float>::infinity());
  EXPECT_EQ(back.geometry.bounds.hi.z, -std::numeric_limits<float>::infinity());
  EXPECT_FALSE(back.settings.camera);
  EXPECT_FALSE(back.settings.names);
}

TEST(Facts, OtherBytesThrow) {
  const std::string bytes = to_bytes(with_everything());
  prepare::Prepared back;
  EXPECT_THROW(from_bytes("", back), std::exception);
  EXPECT_THROW(from_bytes("\xf6", back), std::exception);  // null
  EXPECT_THROW(from_bytes(bytes.substr(0, bytes.size() - 1), back), std::exception);
}

}  // namespace
}  // namespace kdray::cache
