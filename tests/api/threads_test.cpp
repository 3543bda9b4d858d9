// Two threads ask whatever can be asked while a third changes the scene and commits it, again and again: each
// call is answered from one state, before or after. (The thread sanitizer runs this too: CONTRIBUTING.md.)
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "kdray/kdray.h"
#include "support/device.h"
#include "support/meshes.h"

namespace kdray {
namespace {

using test::Cube;

constexpr int kCommits = 20, kHeights = 5, kApart = 3;
constexpr std::size_t kRays = 2000;

class Threads : public test::EachDevice {};
KDRAY_FOR_EACH_DEVICE(Threads);

// Questions whose answers tell where the cube is: at one of the heights 0, 3, 6, ...
class Asker {
 public:
  explicit Asker(const Scene& scene) : scene_(scene) {
    for (std::size_t i = 0; i < kRays; ++i) {
      const float share = static_cast<float>(i) / kRays;
      from_.insert(from_.end(), {1.5f * share - 0.75f, 0.25f - 0.5f * share, 50});
    }
    for (int h = 0; h < kHeights; ++h) points_.insert(points_.end(), {0.125, 0.25, double{kApart} * h});
  }

  void ask(int which) {
    constexpr int kQuestions = 8;
    switch (which % kQuestions) {
      case 0:
        return closest();
      case 1:
        return any();
      case 2:
        return count();
      case 3:
        return all();
      case 4:
        return closest_points();
      case 5:
        return inside();
      case 6:
        return signed_distance();
      default:
        return render();
    }
  }
  int wrong() const { return wrong_; }

 private:
  void expect(bool right) { wrong_ += !right; }
  static bool is_height(double z) {
    const double k = z / kApart;
    return k == std::round(k) && k >= 0 && k < kHeights;
  }
  Rays rays() const { return {from_, down_, {}, {}, mask_}; }

  void closest() {
    std::vector<double> t(kRays);
    scene_.closest(rays(), {.t = t});
    expect(is_height(49 - t[0]) && t == std::vector<double>(kRays, t[0]));
  }
  void any() {
    std::vector<std::uint8_t> hit(kRays);
    scene_.any(rays(), hit);
    expect(hit == std::vector<std::uint8_t>(kRays, 1));
  }
  void count() {
    std::vector<std::uint32_t> counts(kRays);
    scene_.count(rays(), counts);
    expect(counts == std::vector<std::uint32_t>(kRays, 2));
  }
  void all() {
    const AllHits hits = scene_.all(rays());
    bool right = hits.t.size() == 2 * kRays && is_height(49 - hits.t[0]);
    for (std::size_t i = 0; right && i < kRays; ++i)
      right = hits.t[2 * i] == hits.t[0] && hits.t[2 * i + 1] == hits.t[0] + 2;
    expect(right);
  }
  void closest_points() {
    std::vector<double> distance(kHeights);
    scene_.closest_points(points_, {.distance = distance});
    expect(std::count(distance.begin(), distance.end(), 0.75) == 1);  // from the cube's inside
  }
  void inside() {
    std::vector<std::uint8_t> in(kHeights);
    scene_.inside(points_, in);
    expect(std::count(in.begin(), in.end(), 1) == 1);
  }
  void signed_distance() {
    std::vector<double> distance(kHeights);
    scene_.signed_distance(points_, distance);
    expect(std::count(distance.begin(), distance.end(), -0.75) == 1);
  }
  void render() {
    RenderOptions picture;
    picture.width = picture.height = 8;
    expect(scene_.render(picture).rgb.size() == 3 * 8 * 8);
  }

  const Scene& scene_;
  std::vector<float> from_, down_{0, 0, -1};
  std::vector<std::uint32_t> mask_{1};
  std::vector<double> points_;
  int wrong_ = 0;
};

TEST_P(Threads, AskEverythingWhileAnotherChangesAndCommits) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.at(0, 0, 0), cube.triangles}, {.mask = 1});
  CommitOptions options;
  options.device.device = GetParam();
  scene.commit(options);
  std::atomic<bool> done{false};
  std::array<Asker, 2> askers{Asker(scene), Asker(scene)};
  std::array<int, 2> asked{};
  const auto ask = [&](std::size_t me) {
    for (int i = 4 * static_cast<int>(me); !done || asked[me] < 8; ++i, ++asked[me]) askers[me].ask(i);
  };
  std::thread first(ask, 0), second(ask, 1);
  // Beside the cube that moves, a sphere that comes and goes and that these rays don't see: it has another
  // mask, lies far off and is in nobody's way.
  std::thread third([&] {
    for (int i = 0; i < kCommits; ++i) {
      scene.update_vertices(box, cube.at(0, 0, static_cast<float>(kApart * (i % kHeights))));
      const GeometryId ball =
          scene.add_spheres({std::vector<double>{0, 0, -40}, std::vector<double>{1}}, {.mask = 4});
      scene.set_mask(ball, 2);
      scene.enable(ball, i % 3 != 0);
      scene.commit(options);
      scene.remove(ball);
    }
    done = true;
  });
  for (std::thread* thread : {&first, &second, &third}) thread->join();
  for (std::size_t i = 0; i < askers.size(); ++i) {
    EXPECT_EQ(askers[i].wrong(), 0);
    EXPECT_GE(asked[i], 8) << "each question once at least";
  }
}

}  // namespace
}  // namespace kdray
