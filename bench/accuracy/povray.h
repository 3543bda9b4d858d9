// What    POV-Ray's antialiasing settings as points beside kdray's, on the same scene.
// Shape   One question comes first: do the two programs show the same scene? Both trace one ray through each
//         pixel's centre; where these pictures agree, POV-Ray's are held against the same reference as
//         kdray's. Where its model is another one, as with light that passes through glass, they are held
//         against a reference of its own (4x4 as many pixels, each sampled 4x4 times, shrunk), so that
//         nothing counts but what its settings cost.
// Errors  Those of Povray.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/povray/povray.h"
#include "io/image/compare.h"

namespace kdray::bench {

struct PovraySetting {
  std::string name;  // "+AM2 +A0.1 +R3"
  std::vector<std::string> flags;
  int depth = 16;
};

std::vector<PovraySetting> povray_settings(bool quick);

class PovrayPoints {
 public:
  // `plain` is kdray's picture of one sample at each pixel's centre.
  PovrayPoints(const scene::Scene& scene, const image::Image& reference, const image::Image& plain,
               int threads, bool quick);

  const std::vector<PovraySetting>& settings() const { return settings_; }
  const image::Difference& model_difference() const { return model_difference_; }  // at the pixels' centres
  bool has_own_reference() const { return has_own_reference_; }
  const image::Image& reference() const { return reference_; }
  // Seconds and the picture as it is shown.
  Povray::Traced trace(std::size_t setting) const;

 private:
  std::vector<PovraySetting> settings_;
  std::unique_ptr<Povray> deep_, shallow_;
  image::Difference model_difference_;
  bool has_own_reference_ = false;
  image::Image reference_;
  int threads_;
};

}  // namespace kdray::bench
