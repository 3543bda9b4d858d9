// A hit gives the pictures and hits of a miss, bit for bit, on every device.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "accel/cache/samples.h"
#include "kdray/kdray.h"
#include "support/device.h"

namespace kdray {
namespace {

constexpr unsigned kSeed = 43;  // of the rays

std::vector<Ray> some_rays() {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Ray> rays(20000);
  for (Ray& r : rays) {
    r = {{2 * uniform(random), 2 * uniform(random), 2 * uniform(random)}, 0, {}, 100};
    for (float& d : r.direction) d = uniform(random);
  }
  return rays;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

class CachedPictures : public test::EachDevice {};

TEST_P(CachedPictures, AreThoseOfTheSceneItself) {
  const test::Folder folder;
  const SceneCache cache(test::all_kept_in(folder / "cache"));
  const DeviceOptions device{.device = GetParam()};
  const std::vector<Ray> rays = some_rays();
  for (const char* name : {"balls", "tree", "tetra", "teapot"}) {
    SCOPED_TRACE(name);
    const auto file = folder.put(std::string(name) + ".nff", test::nff(name, 3));
    EXPECT_FALSE(cache.find(file));
    const PreparedScene made(Scene::load(file));
    EXPECT_TRUE(cache.keep(made));
    const std::optional<PreparedScene> found = cache.find(file);
    ASSERT_TRUE(found);
    Renderer renderer(made, device), cached(*found, device);
    const RenderOptions options{.width = 120, .height = 90, .channels = {"depth", "normal", "primitive"}};
    const Picture picture = renderer.render(options), again = cached.render(options);
    EXPECT_TRUE(same_bits(picture.rgb, again.rgb));
    for (std::size_t i = 0; i < picture.channels.size(); ++i)
      EXPECT_TRUE(same_bits(picture.channels[i].values, again.channels.at(i).values));
    for (const Traversal t : {Traversal::binary, Traversal::automatic})
      EXPECT_TRUE(same_bits(renderer.trace(rays, false, 1, t), cached.trace(rays, false, 1, t)));
  }
}

// The buffers keep the arrays, the arrays the mapping: nothing else has to live.
TEST_P(CachedPictures, OutliveSceneAndFile) {
  const test::Folder folder;
  const SceneCache cache(test::all_kept_in(folder / "cache"));
  const auto file = folder.put("balls.nff", test::nff("balls", 2));
  const DeviceOptions device{.device = GetParam()};
  const RenderOptions options{.width = 64, .height = 64};
  const Picture wanted = Renderer(Scene::load(file), {}, device).render(options);
  cache.keep(PreparedScene(Scene::load(file)));
  std::optional<PreparedScene> found = cache.find(file);
  ASSERT_TRUE(found);
  Renderer renderer(*found, device);
  found.reset();
  std::filesystem::remove_all(folder.path());
  EXPECT_TRUE(same_bits(renderer.render(options).rgb, wanted.rgb));
}

KDRAY_FOR_EACH_DEVICE(CachedPictures);

TEST(PreparedScene, TellsWhatTheSceneAskedFor) {
  const test::Folder folder;
  const auto file = folder.put("balls.nff", test::nff("balls", 1));
  const PreparedScene made(Scene::load(file));
  EXPECT_EQ(made.settings().settings.width, 512);
  EXPECT_TRUE(made.settings().spheres.empty());
  EXPECT_EQ(made.warnings(), Scene::load(file).warnings());
  EXPECT_GT(made.prepared().seconds.load, 0);
}

}  // namespace
}  // namespace kdray
