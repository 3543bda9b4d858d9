// What    A soak: random combinations of scene, mode, division, balance, queues, tiles, buffers, device
//         memory and faults. None hangs (the test's time limit), loses a ray (exact counts) or changes a bit.
// Shape   KDRAY_SOAK combinations, 20 by default; combination i has the seed kSeed + i, so each can be run
//         alone (KDRAY_SOAK_FIRST). scripts/soak runs many.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "kdray/kdray.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "scene/generate/generate.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 20261121;

int number_from(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

struct Combination {
  std::string words;
  std::size_t scene = 0;
  int queues = 1;
  std::string faults;
  RenderOptions options;
};

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  int below(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return *(values.begin() + below(static_cast<int>(values.size())));
  }

 private:
  std::mt19937_64 random_;
};

// Faults on some queues, never on all.
std::string faults_of(Dice& dice, int queues) {
  std::string faults;
  const int spared = dice.below(queues);
  for (int queue = 0; queue < queues; ++queue)
    if (queue != spared && dice.below(3) == 0)
      faults += fmt::format("{}{}@{}", faults.empty() ? "" : ",", queue, 1 + dice.below(6));
  return faults;
}

Combination draw(std::uint64_t seed, std::size_t n_scenes) {
  Dice dice(seed);
  Combination c;
  c.scene = static_cast<std::size_t>(dice.below(static_cast<int>(n_scenes)));
  RenderOptions& o = c.options;
  o = exact_options(dice.one_of({33, 64, 150}), dice.one_of({17, 50, 101}), dice.one_of({1, 2, 5, 9}));
  o.samples = dice.one_of({1, 1, 1, 3});
  o.mode = dice.one_of({Mode::pdprt, Mode::odprt, Mode::odprt, Mode::odprt});
  o.division = dice.one_of({Division::bag, Division::contiguous, Division::interleaved});
  o.balance = dice.one_of({Balance::sah, Balance::pilot, Balance::dynamic});
  o.tile_width = dice.one_of({0, 1, 8, 13, 64});
  o.tile_height = o.tile_width == 0 ? 0 : dice.one_of({1, 8, 32});
  c.queues = 1 + dice.below(8);
  if (o.mode == Mode::odprt) {
    o.ray_buffer = dice.one_of({0, 0, 1, 2, 17, 300});
    if (dice.below(4) == 0) o.device_memory = std::uint64_t{64} << 20;
  }
  if (dice.below(2) == 0) c.faults = faults_of(dice, c.queues);
  c.words = fmt::format(
      "scene {}, {}x{}, depth {}, samples {}, mode {}, division {}, balance {}, tiles {}x{}, queues {}, "
      "buffer {}, "
      "device memory {}, faults '{}'",
      c.scene, o.width, o.height, o.depth, o.samples, static_cast<int>(o.mode), static_cast<int>(o.division),
      static_cast<int>(o.balance), o.tile_width, o.tile_height, c.queues, o.ray_buffer, o.device_memory,
      c.faults);
  return c;
}

struct Shot {
  Picture picture;
  nlohmann::json rays;
};

Shot render(const PreparedScene& scene, const RenderOptions& options, int queues, const std::string& faults) {
  DeviceOptions device;
  device.queues = queues;
  Renderer renderer = api::make_renderer(scene, device_of(device), {.faults = faults});
  Picture picture = renderer.render(options);
  return {std::move(picture), statistics_of(renderer)["rays"]};
}

std::vector<PreparedScene> soak_scenes() {
  std::vector<PreparedScene> scenes;
  for (const NamedScene& s : small_scenes()) scenes.emplace_back(Scene{s.make()});
  const Folder folder;
  for (const char* const name : {"balls", "gears", "mount", "rings", "teapot", "tetra", "tree"}) {
    std::ostringstream text;
    generate::generate(name, 2, text);
    scenes.emplace_back(Scene::load(folder.put(std::string(name) + ".nff", text.str())));
  }
  return scenes;
}

TEST(Soak, RandomCombinations) {
  const std::vector<PreparedScene> scenes = soak_scenes();
  const int first = number_from("KDRAY_SOAK_FIRST", 0), n = number_from("KDRAY_SOAK", 20);
  for (int i = first; i < first + n; ++i) {
    const Combination c = draw(kSeed + static_cast<std::uint64_t>(i), scenes.size());
    SCOPED_TRACE(fmt::format("combination {}: {}", i, c.words));
    RenderOptions plain = c.options;
    plain.mode = Mode::pdprt;
    plain.device_memory = 0;
    plain.tile_width = plain.tile_height = 0;
    const Shot expected = render(scenes[c.scene], plain, 1, ""),
               got = render(scenes[c.scene], c.options, c.queues, c.faults);
    EXPECT_TRUE(same_bits(expected.picture.rgb, got.picture.rgb));
    EXPECT_EQ(expected.rays, got.rays);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace kdray::test
