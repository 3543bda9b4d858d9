// What    `kdray bench accuracy`: time against error. A frame at each setting of samples, depth, least
//         weight, reach of lights, traversal and tree, held against a reference; beside it POV-Ray's
//         antialiasing.
// Shape   Interleaved: a round is a frame at every setting; one before that is not counted, and gives the
//         pictures that are judged. POV-Ray's pictures are made in the first rounds only, since they take so
//         much longer; the one that is judged is timed too.
// Errors  Those of scene::load, Renderer and Povray.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/accuracy/settings.h"
#include "bench/measure/progress.h"
#include "bench/measure/report.h"
#include "io/image/compare.h"

namespace kdray::bench {

inline constexpr const char* kPovray = "POV-Ray";  // its points' group

struct AccuracyOptions {
  std::vector<std::string> scenes = {"balls", "gears", "lamps", "chessboard", "penumbra"};
  int width = 512, height = 512;
  int repeat = 5;
  int reference_samples = 256;
  bool povray = true, quick = false;
  std::string device = "auto";
};

// What adaptive sampling says of its picture.
struct Taken {
  double per_pixel = 0;  // samples
  double believed = 0;   // RMSE; of the picture before it is cut off at white
};

struct AccuracyPoint {
  std::string group, name, label;
  Setting setting = {};  // of kdray's
  Spread seconds = {};
  image::Difference error = {};     // against the reference
  double change = 0;                // RMSE against the base's picture
  std::optional<Taken> taken = {};  // adaptive sampling
  bool on_front = false;  // no other point of the same program is both faster and nearer to the reference
};

struct PovrayRun {
  std::vector<AccuracyPoint> points;
  image::Difference model_difference;  // of one ray through each pixel's centre, from kdray's
  // Where that is not small: its points are not held against kdray's reference.
  bool has_own_reference = false;
};

struct AccuracyRun {
  std::string scene;
  std::size_t n_primitives = 0;
  Machine machine;
  bool reference_in_double = false, reference_is_exact = false;  // the latter: nothing was rendered for it
  double reference_seconds = 0, reference_error = 0;             // RMSE that the reference itself may have
  std::vector<AccuracyPoint> points;                             // [0] is the base
  std::optional<PovrayRun> povray;
};

struct AccuracyCalls {
  std::function<void(std::span<const AccuracyRun>)> done;  // a scene: all so far, it last
  Working working;
  // The reference and, by the name of its setting, where each picture differs from it.
  std::function<void(const std::string& scene, const std::string& name, const image::Image&)> picture;
};

std::vector<AccuracyRun> bench_accuracy(const AccuracyOptions& options, const AccuracyCalls& calls);

// Settings that have to keep the base's picture and don't: 0.
std::size_t count_unlike_base(std::span<const AccuracyRun> runs);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

std::string table_of(const AccuracyRun& run);
Json json_of(std::span<const AccuracyRun> runs, const AccuracyOptions& options);

// The file of a picture: "balls_16_samples_depth_16_base.png".
std::string picture_name(const std::string& scene, const std::string& name);

}  // namespace kdray::bench
