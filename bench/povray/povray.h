// What    POV-Ray as a program beside kdray: how long it takes for a picture, and the picture.
// Shape   What it measures is POV-Ray's own "Trace Time": after parsing and building, with no display. For
//         times alone, there is no antialiasing and no file.
// Errors  Without povray on the path there is none. One that fails is an Error that quotes its last words.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "base/temporary.h"
#include "io/image/image.h"
#include "scene/model/scene.h"

namespace kdray::bench {

// Writes a scene as a POV-Ray file, so that POV-Ray can be timed on the same picture. `depth` as kdray counts
// it: the eye ray is 1. Rays of less weight than `min_weight` are not followed. What POV-Ray has no word for
// is left out: attenuation but by the distance's square, ranges, spots, emission.
void write_pov(std::ostream& out, const scene::Scene& scene, double aspect, int depth, double min_weight);
// Whether nothing would be left out.
bool pov_has_words_for(const scene::Scene& scene);

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
