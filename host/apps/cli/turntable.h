// What    --turntable N: where the camera is in each of N frames, which go once around what it looks at.
//         Where it was chosen for the scene, it is as far off as takes all of the scene into every frame; in
//         a room it looks around.
#pragma once

#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::cli {

class Turntable {
 public:
  // `seen` is the scene, without its primitives, as it is seen by `asked`; `aspect` is the picture's width
  // divided by its height.
  Turntable(const scene::Scene& seen, const View& asked, double aspect);

  // The view after so many turns about the axis that is up, counterclockwise as seen from above.
  View after(double turns) const;

 private:
  View asked_;
  scene::Camera camera_;
  bool looks_around_ = false;
};

}  // namespace kdray::cli
