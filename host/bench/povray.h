// What    POV-Ray as a program beside kdray: how long it takes for a picture.
// Shape   Its own "Trace Time": after parsing and building, no antialiasing, no display, no picture file.
// Errors  Without povray on the path there is none. One that fails is an Error that quotes its last words.
#pragma once

#include <filesystem>
#include <string>

#include "scene/scene.h"

namespace kdray::bench {

bool has_povray();

// A scene file of POV-Ray's in a temporary folder, gone with this.
class Povray {
 public:
  Povray(const scene::Scene& scene, int width, int height, int depth, double min_weight);
  ~Povray();
  Povray(const Povray&) = delete;
  Povray& operator=(const Povray&) = delete;

  double trace_seconds(int threads) const;

 private:
  std::filesystem::path folder_;
  int width_, height_;
};

// The seconds of the trace in what POV-Ray prints, or < 0 where it doesn't say.
double trace_time_in(const std::string& output);

}  // namespace kdray::bench
