// What    `kdray bench frames`: whole frames, scene by scene, with the time of each stage; beside them, of
//         NFF scenes, the same picture by POV-Ray and by a renderer on Embree (bench/embree/whitted.cpp).
// Shape   Interleaved: a round is a frame of kdray's, one by each Embree, a picture of POV-Ray's (in the
//         first three rounds, since it takes so much longer). One of each before that is not counted.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/progress.h"
#include "bench/workload/kinds.h"

namespace kdray::bench {

struct FramesOptions {
  std::vector<std::string> scenes = {"balls", "gears", "mount", "rings", "teapot", "tetra", "tree"};
  int width = 1024, height = 1024, depth = 5;
  int repeat = 7;
  bool embree = true;  // beside kdray, where there is one
  std::string device = "auto";
};

struct EmbreeFrame {
  std::string name;  // "Embree 4"
  Spread seconds;
  std::uint64_t n_rays = 0;
};

struct FrameResult {
  std::string scene;
  KindCounts n_primitives;
  Machine machine;
  Spread seconds;                                      // seconds.render
  std::vector<std::pair<std::string, Spread>> stages;  // device seconds by stage
  std::map<std::string, std::uint64_t> rays;           // by kind, and "total"
  std::optional<Spread> povray_seconds;
  std::vector<EmbreeFrame> embree;

  const EmbreeFrame* fastest_embree() const;  // null without
  std::size_t n_rays() const { return rays.at("total"); }
};

std::vector<FrameResult> bench_frames(const FramesOptions& options, const Progress<FrameResult>& progress);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

std::string table_of(const FrameResult& frame);
Json json_of(std::span<const FrameResult> frames, const FramesOptions& options);

}  // namespace kdray::bench
