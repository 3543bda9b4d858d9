// What    The benches that build trees. `kdray bench build`: what trees of each quality cost to build and
//         what they gain, scene by scene, beside Embree's medium build; with `variants` the builders of the
//         thesis' chapter 5 too. --growth: how the time for each triangle and the memory grow with the size
//         of a mesh, a displaced sphere. --hostile: building over meshes made to break a builder, each
//         against a displaced sphere of as many triangles. `kdray bench depth`: the thesis' study of the
//         maximum tree depth: what trees of every depth cost to build, to hold and to trace.
// Shape   All builders of a scene or a mesh take turns; so do their trees with each class of rays.
// Units   Seconds; milliseconds in tables. Every key of the JSON is in docs/bench.md.
// Errors  Those of scene::load and Renderer. Hits that differ are counted, not thrown.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/build/builders.h"
#include "bench/measure/progress.h"
#include "bench/workload/kinds.h"
#include "bench/workload/rays.h"

namespace kdray::bench {

// The rays that trees are compared on, primary, diffuse and random ones: classes that have any.
std::vector<RayClass> build_rays(const scene::Scene& scene, int rays, Renderer& renderer);

// ---- bench build

struct BuildOptions {
  std::vector<std::string> scenes = {};  // empty: the built-in ones
  bool variants = false;
  int rays = 1 << 18;  // of a class, at the most
  int repeat = 5;      // rounds
  bool embree = true;  // beside kdray, where there is one
  std::string device = "auto";
};

struct TraceTimes {
  std::string ray_class;
  std::size_t n_rays = 0;
  Spread seconds;
  std::size_t n_not_identical = 0;  // hits that are not those of the balanced tree
};

struct BuilderResult {
  std::string builder;
  BuildSpreads seconds;
  std::optional<TreeFacts> tree;  // none of Embree's
  std::vector<TraceTimes> traces;

  // Seconds for a million rays of each class.
  double trace_seconds() const;
};

struct BuildRun {
  std::string scene;
  KindCounts n_primitives;  // that can be hit
  Machine machine;
  std::vector<BuilderResult> builders;

  const BuilderResult* embree() const;  // the fastest; null without
};

std::vector<BuildRun> bench_build(const BuildOptions& options, const Progress<BuildRun>& progress);
std::size_t count_not_identical(std::span<const BuildRun> runs);

std::string table_of(const BuildRun& run);
Json json_of(std::span<const BuildRun> runs, const BuildOptions& options);

// ---- bench build --growth

struct GrowthOptions {
  std::vector<std::size_t> sizes = {10000, 100000, 1000000, 10000000};  // triangles
  int repeat = 5;  // rounds; 3 at the most for the largest, which all but `best` build
  bool embree = true;
};

struct GrowthRow {
  std::string builder;
  BuildSpreads seconds;
  std::optional<std::uint64_t> peak_bytes;  // beyond the scene; where the system tells
  std::optional<double> duplication;        // references for each triangle; none of Embree's
};

struct GrowthResult {
  std::size_t n_triangles = 0;
  std::vector<GrowthRow> rows;
};

std::vector<GrowthResult> bench_growth(const GrowthOptions& options, const Progress<GrowthResult>& progress);

std::string table_of(const GrowthResult& result);
Json json_of(std::span<const GrowthResult> results, const GrowthOptions& options);

// ---- bench build --hostile

struct HostileOptions {
  std::vector<std::string> meshes = {};  // empty: all
  int triangles = 1000000;
  int repeat = 5;
  BuildQuality quality = BuildQuality::balanced;
};

struct BuiltMesh {
  std::size_t n_triangles = 0;  // that are left when degenerate ones have been dropped
  BuildSpreads seconds = {};
  TreeFacts tree = {};
};

struct HostileResult {
  std::string mesh, what;
  BuiltMesh hostile, plain;

  double times_plain() const { return hostile.seconds.total.median / plain.seconds.total.median; }
  double cpu_times_plain() const { return hostile.seconds.cpu.median / plain.seconds.cpu.median; }
};

std::vector<HostileResult> bench_hostile(const HostileOptions& options,
                                         const Progress<HostileResult>& progress);

std::string hostile_heading();
std::string table_of(const HostileResult& result);
Json json_of(std::span<const HostileResult> results, const HostileOptions& options);

// ---- bench depth

// Depths go from 0 in steps of 2 up to the usual one of the scene, then 4 and 8 beyond. Every round makes
// each of the trees anew, traces the same rays over it and forgets it.
struct DepthOptions {
  std::vector<std::string> scenes = {"boxes", "balls", "rings", "displaced"};
  BuildQuality quality = BuildQuality::balanced;
  int rays = 1 << 16;  // of a class, at the most
  int repeat = 3;      // rounds
  std::string device = "auto";
};

struct DepthRow {
  int max_depth = 0;  // that was allowed; TreeFacts has what was reached
  BuildSpreads seconds;
  std::optional<Spread> trace_seconds;  // for a million rays of each class
  TreeFacts tree;
  std::size_t n_not_identical = 0;  // hits that are not those of the usual depth
};

struct DepthRun {
  std::string scene, device;
  std::size_t n_primitives = 0;
  int usual_depth = 0;
  std::vector<DepthRow> rows;
};

// The depths for a scene whose usual one is this.
std::vector<int> depths_to_try(int usual);

std::vector<DepthRun> bench_depth(const DepthOptions& options, const Progress<DepthRun>& progress);
std::size_t count_not_identical(std::span<const DepthRun> runs);

std::string table_of(const DepthRun& run);
Json json_of(std::span<const DepthRun> runs, const DepthOptions& options);

}  // namespace kdray::bench
