// What    A scene on a device that queries are put to, in its own space: rays and triangles have the same
//         coordinates, and nothing is rounded on the way.
// Shape   Scenes share programs where these are built alike. There is one device, the first that is usable.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "accel/prepare/prepared.h"
#include "engine/query/all_hits.h"
#include "engine/wavefront/scene_buffers.h"
#include "support/device.h"

namespace kdray::test {

enum class Space { own, worlds };
enum class Blocks { suited, of_eight };  // of_eight: as a scene of a million primitives has them

// A scene as QueriedScene prepares it; `kept` is the space that it may keep.
prepare::Prepared prepared_of(const scene::Scene& scene, Blocks blocks,
                              const std::optional<LocalSpace>& kept = {});

class QueriedScene {
 public:
  explicit QueriedScene(const scene::Scene& scene, Space space = Space::own, Blocks blocks = Blocks::suited);
  explicit QueriedScene(prepare::Prepared&& prepared);

  query::Target target(Traversal walk = Traversal::automatic);
  std::span<const layout::Triangle> triangles() const { return prepared_.flat.triangles; }
  const prepare::Prepared& prepared() const { return prepared_; }
  float reach() const;  // the largest coordinate

  query::LocalHits all(std::span<const Ray> rays, const query::CollectOptions& options = {}) {
    return query::all_hits(target(), rays, options);
  }
  std::vector<std::uint32_t> count(std::span<const Ray> rays, const query::CollectOptions& options = {}) {
    return query::count_hits(target(), rays, options);
  }

 private:
  prepare::Prepared prepared_;
  wavefront::SceneBuffers buffers_;
  std::shared_ptr<wavefront::Programs> programs_;
};

// A fixture of tests that need a device.
class OnDevice : public testing::Test {
 protected:
  void SetUp() override {
    if (usable_devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

Ray ray_from(const vec3& origin, const vec3& direction, float t_min = 0,
             float t_max = std::numeric_limits<float>::infinity());
std::string in_words(const Ray& ray);

}  // namespace kdray::test
