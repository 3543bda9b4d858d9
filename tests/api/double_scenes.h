// What    Scenes of doubles of the tests' meshes, on each device.
#pragma once

#include "api/double_oracle.h"
#include "kdray/kdray.h"
#include "support/device.h"

namespace kdray::test::doubles {

class OnEachDevice : public EachDevice {
 protected:
  CommitOptions options() const {
    CommitOptions options;
    options.device.device = GetParam();
    options.tree.geometry = VertexPrecision::float64;
    return options;
  }
  Scene scene_of(const DoubleMesh& mesh) const {
    Scene scene;
    scene.add_mesh({mesh.points(), mesh.triangles});
    scene.commit(options());
    return scene;
  }

  // So many rays that the device looks at them first.
  static constexpr std::size_t kMany = std::size_t{1} << 15;
};

}  // namespace kdray::test::doubles
