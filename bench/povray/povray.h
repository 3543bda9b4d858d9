// What    POV-Ray as a program beside kdray: how long it takes for a picture, and the picture.
// Shape   What it measures is POV-Ray's own "Trace Time": after parsing and building, with no display. For
//         times alone, there is no antialiasing and no file.
// Errors  Without povray on the path there is none. One that fails is an Error that quotes its last words.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/temporary.h"
#include "io/image/image.h"
#include "scene/model/scene.h"

namespace kdray::bench {

bool has_povray();

// A scene file of POV-Ray's in a temporary folder, gone with this.
class Povray {
 public:
  Povray(const scene::Scene& scene, int width, int height, int depth, double min_weight);

  double trace_seconds(int threads) const;

  struct Traced {
    double seconds = 0;
    image::Image image;  // linear, as it is: values above 1 too
  };
  // Antialiasing is as `flags` have it: "+AM2", "+A0.1", ...
  Traced trace(int threads, const std::vector<std::string>& flags) const;

 private:
  double run_with(int threads, const std::vector<std::string>& flags) const;

  std::unique_ptr<Temporary> temporary_;
  std::filesystem::path folder_;
  int width_, height_;
};

// The seconds of the trace in what POV-Ray prints, or < 0 where it doesn't say.
double trace_time_in(const std::string& output);

}  // namespace kdray::bench
