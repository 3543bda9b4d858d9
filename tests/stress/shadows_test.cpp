// A light on a surface, just above it and just behind it: what it shines on is lit at every pixel, or at
// none.
#include <gtest/gtest.h>

#include <cmath>

#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "stress/random.h"
#include "stress/table.h"
#include "stress/traced.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 6600;
constexpr int kSize = 128;

struct Room {
  double scale;
  dvec3 right, up, forward;  // how it is turned
};

// A floor at height 0 and a ceiling at 1, a light at `height` over the floor, seen from below the ceiling.
scene::Scene room(const Room& r, double height, bool ball) {
  const auto at = [&](double x, double y, double z) {
    return r.scale * (x * r.right + y * r.up + z * r.forward);
  };
  oracle::SceneBuilder b;
  const scene::Material matte = oracle::matte(vec3(1));
  b.quad(at(-2, 0, -2), at(4, 0, 0), at(0, 0, 4), matte);
  if (ball)
    b.sphere(at(0, 2, 0), r.scale, matte);  // its lowest point is where the light is
  else
    b.quad(at(-2, 1, -2), at(4, 0, 0), at(0, 0, 4), matte);
  b.light(at(0.1 * !ball, height, 0.05 * !ball));
  b.camera(at(0.3, 0.9, -0.2), at(0, 0, 0), 1.2, r.forward);
  return b.scene();
}

// Pixels that are not as they should be.
std::uint64_t wrong_pixels(const scene::Scene& model, bool lit, Traversal traversal) {
  Renderer renderer(Scene{scene::Scene(model)});
  RenderOptions options = test::exact_options(kSize, kSize, 1);
  options.traversal = traversal;
  const Picture picture = renderer.render(options);
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
    wrong += lit ? !(picture.rgb[i] > 0.01f) : picture.rgb[i] != 0;
  return wrong;
}

struct Lamp {
  const char* name;
  double height;
  bool lit, ball;
};
void PrintTo(const Lamp& p, std::ostream* out) {
  *out << p.name;
}

class Shadows : public testing::TestWithParam<Lamp> {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

TEST_P(Shadows, OfALightNearASurface) {
  const Lamp& lamp = GetParam();
  Tally tally("shadows", std::string("a light ") + lamp.name);
  for (std::uint64_t i = 0; i < (is_full() ? 40 : 2); ++i) {
    Random random(kSeed, i);
    Room r{random.log_uniform(1e-4, 1e4), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (i % 2 == 1) {
      r.up = random.direction();
      r.right = glm::normalize(glm::cross(r.up, random.direction()));
      r.forward = glm::cross(r.right, r.up);
    }
    const scene::Scene model = room(r, lamp.height, lamp.ball);
    for (std::size_t w = 0; w < kWalks.size(); ++w) {
      tally.row(w).rays += kSize * kSize;
      tally.row(w).wrong += wrong_pixels(model, lamp.lit, kWalks[w].traversal);
    }
  }
  tally.publish();
  EXPECT_EQ(tally.wrong(), 0) << "seed " << kSeed;
}

INSTANTIATE_TEST_SUITE_P(Light, Shadows,
                         testing::Values(Lamp{"on the ceiling", 1, true, false},
                                         Lamp{"just below the ceiling", 1 - 0x1p-17, true, false},
                                         Lamp{"just above the ceiling", 1 + 0x1p-15, false, false},
                                         Lamp{"on a ball", 1, true, true},
                                         Lamp{"just inside of a ball", 1 + 0x1p-14, false, true},
                                         Lamp{"just below the floor", -0x1p-15, false, false}),
                         [](const auto& info) {
                           std::string name(info.param.name);
                           for (char& c : name) c = c == ' ' ? '_' : c;
                           return name;
                         });

}  // namespace
}  // namespace kdray::stress
