// What    `kdray bench queries`: the same questions to kdray's public interface and to Embree, from arrays in
//         memory to arrays in memory, in batches from one ray to a million; and how long it takes from the
//         arrays of a mesh to the first answer.
// Shape   Interleaved: a round asks each side the same batches, one after the other. Before that every form
//         of a side is asked twice (once, where there is to be one round), for its best to be chosen; there
//         answers are compared.
// Errors  Those of scene::load and kdray/scene.h; ErrorCode::input for a scene without triangles.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/progress.h"
#include "bench/measure/report.h"
#include "bench/race/asker.h"
#include "kdray/kdray.h"

namespace kdray::bench {

// The mesh as a scene that has been committed.
Scene kdray_scene(const MeshArrays& mesh, const DeviceOptions& device,
                  VertexPrecision geometry = VertexPrecision::float32);

// kdray as a side, by way of its public interface. The mesh has to outlive it.
Side kdray_side(const std::shared_ptr<const Scene>& scene, const MeshArrays& mesh,
                const DeviceOptions& device);
// The same with vertices, rays and answers in doubles (TreeOptions::geometry).
Side double_side(const MeshArrays& mesh, const DeviceOptions& device);

struct QueriesOptions {
  std::vector<std::string> scenes = {"boxes", "spheres"};
  std::vector<std::string> sets = {}, questions = {};      // empty: all
  std::vector<int> batches = {1, 100, 10'000, 1'000'000};  // rays or points to a call; no more than `rays`
  int rays = 1'000'000;                                    // of a set
  int repeat = 5;                                          // rounds
  bool embree = true;                                      // beside kdray, where there is one
  VertexPrecision geometry = VertexPrecision::float32;     // float64: kdray's doubles beside its floats
  std::string device = "auto";
};

// Of one call, in seconds; `cpu` is that of all of the process' threads.
struct SideResult {
  std::string side, form;
  Spread wall, cpu;
  std::size_t n_differing = 0;  // answers that are others than kdray's
};

// A question about a set, in batches of one size.
struct CellResult {
  std::string question, set;
  std::size_t batch = 0, calls = 0;  // of a round
  std::vector<SideResult> sides;     // kdray's first
  // kdray's walk alone, with the whole set on the device already (as `bench rays` has it).
  std::optional<Spread> on_device;
};

struct QueriesRun {
  std::string scene;
  std::size_t n_triangles = 0;
  Machine machine;
  double first_in_process = 0;            // seconds to commit for the first time, with programs to be had
  std::vector<SideResult> first_answers;  // from arrays
  std::vector<CellResult> cells;
};

std::vector<QueriesRun> bench_queries(const QueriesOptions& options, const Progress<QueriesRun>& progress);

// The results for people (a table) and for programs (JSON: docs/bench.md has its keys), in report.cpp.

std::string table_of(const QueriesRun& run);
Json json_of(std::span<const QueriesRun> runs, const QueriesOptions& options);

}  // namespace kdray::bench
