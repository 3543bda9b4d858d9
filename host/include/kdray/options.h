// What    The options of kdray's public interface: how a tree is built, which devices are used, how a frame
//         is rendered.
// Shape   Plain values, which every module below the interface may see; kdray/kdray.h includes them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kdray/cancel.h"
#include "kdray/model.h"

namespace kdray {

// How much time goes into the tree (docs/design/kdtree.md). A choice changes times and memory, never a hit.
enum class BuildQuality { fast, balanced, best };

// What becomes of meshes that a file shows many times. A choice changes time and memory, and at edges the
//         picture (docs/design/instances.md).
enum class Instances {
  automatic,  // they are held once where copies would be over a million primitives
  flat,       // all are copied
  kept        // all that the file names as such are held once
};

// How a scene looks whose file has neither camera nor lights.
enum class Look {
  plain,  // two lights, and what else the file says
  studio  // PreparedScene::in_studio()
};

// How a scene file is read.
struct LoadOptions {
  // Triangles without normals get them from the faces around each corner, where the surface turns by no more
  // than this: 0 to 180 degrees. Empty: they stay flat.
  std::optional<double> smooth_degrees = {};
  // Of a glTF file: the second of its animation that is seen. Empty: nodes are as the file has them, at rest.
  std::optional<double> time = {};
  // Of several animations the number or the name of one, or "all" of them; empty: the first.
  std::string animation = {};
  // The most that the texels of pictures may take; larger pictures are made smaller until they fit; 0: no
  // limit.
  std::uint64_t texture_bytes = 0;
  Instances instances = Instances::automatic;
  // A folder below which a scene may name files (pictures, buffers) that are not beside it or below; empty:
  // none.
  std::filesystem::path asset_root = {};
  bool operator==(const LoadOptions&) const = default;
};

// What the kernels compute in. The scene is the same, stored as float. float64 (C++'s double) is the
// reference for float's rounding: slower, by the binary walk and PDPRT alone, on devices that have it.
enum class Precision { float32, float64 };

// What vertices and shapes are to queries. float64: they are as they were given, in doubles, which are kept
// beside the floats of the scene, and answers are those of exact arithmetic, with shapes to 2^-96 of their
// size (slower). Instances become copies. Pictures are of the floats. automatic: float64 for triangles alone,
// without instances, of which floats about the scene's centre lose a bit, else float32.
enum class VertexPrecision { float32, float64, automatic };

struct TreeOptions {
  BuildQuality quality = BuildQuality::balanced;
  int max_depth = -1;  // -1: 8 + 1.3*log2(N)
  double cost_traverse = 1.0;
  double cost_intersect = 2.0;  // of one test: of a block of primitives
  // The most that the scene may take when it is traced; the tree gets coarser; 0: no limit.
  std::uint64_t memory_bytes = 0;
  // Is made too; few options take it (takes_binary_form). Unset: for a Renderer, and not by Scene::commit().
  std::optional<bool> binary_form = {};
  VertexPrecision geometry = VertexPrecision::float32;
  bool operator==(const TreeOptions&) const = default;
};

// Prepared scenes kept in a folder between runs (docs/design/cache.md). Several processes and threads may use
// one at once.
struct CacheOptions {
  std::filesystem::path folder = {};  // made when something is to be kept; empty: there is no cache
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // of all scenes; the least recently used go first
  // What takes less is not kept: it is read and built about as fast as it would be found. (A bound on time
  // would keep a scene in one run and not in the next.)
  std::uint64_t min_bytes = std::uint64_t{2} << 20;
};

// How a device's work is cut into launches (docs/devices.md). A choice changes time, never the picture or a
// hit.
enum class Schedule {
  automatic,  // slices on CPUs, global elsewhere
  slices,     // a work-item takes a slice of the picture through all stages of many waves
  global      // a launch for each stage over all slices, one ray per work-item for tracing: for GPUs
};

// Settings that change time alone, never a bit of a picture or a hit; 0: kdray's own choice. `kdray tune`
// finds them, and docs/tune.md tells what each does.
struct Tuning {
  int tile = 0, batch = 0, slices = 0, waves = 0, work_group = 0;
  int packets = 0, batch_rays = 0, spread = 0, distance = 0, prefetch = 0;
  bool operator==(const Tuning&) const = default;
};

struct DeviceOptions {
  // "auto", "cpu", "gpu", a number from `kdray devices`, or a part of a name; several with commas between
  // them
  std::string device = "auto";
  int queues = 1;         // one per sub-device of equal size when > 1; dealt out over several devices
  int work_group = 0;     // local size of the per-ray kernels; 0: chosen for the device
  int compute_units = 0;  // that many of the device's, as a sub-device; 0: all of them
  Schedule schedule = Schedule::automatic;
  std::filesystem::path programs = {};  // folder where built programs are looked for and kept; empty: none
  // What is built stays in memory for others of this process: for programs that commit many scenes. Unset:
  // what Scene::commit() builds.
  std::optional<bool> remember_programs = {};
  // Programs of just the scene's features are made though there may be some in that folder that have more and
  // would do: these take a few percent longer over a frame, and no seconds to compile.
  bool exact_programs = false;
  // File of what `kdray tune` found; empty, or none there: what kdray ships with.
  std::filesystem::path tunings = {};
  // Told why, in a line, where that file is of no use.
  std::function<void(const std::string&)> tunings_ignored = {};
  // True: a compiler begins to work; false: it ends. From any thread; may nest.
  std::function<void(bool)> building = {};
  // Told of each device that kdray would prefer, but can't use, and of each driver that it has to leave out.
  std::function<void(const std::string&)> left_out = {};
};

// How rays find their way through the tree. A choice changes time, never a hit (docs/traversal.md).
enum class Traversal {
  automatic,  // per 16 rays, from how coherent they are
  binary,     // the binary tree, one ray per work-item: the baseline
  wide,       // the wide tree, one ray per work-item
  packet,     // the wide tree, 16 coherent rays to a vector, several packets in flight
  batch       // the wide tree, many independent rays in flight
};

// How a frame is divided among the queues (docs/modes.md). A choice changes time and memory, never the
// picture.
enum class Mode {
  automatic,  // what fits and is measured to be the fastest
  pdprt,      // the pixels are divided: every queue sees the whole scene
  odprt       // the scene is divided: a queue holds some of its subtrees, and rays travel
};
enum class Division { bag, contiguous, interleaved };  // PDPRT: how queues come by their tiles
enum class Balance {                                   // ODPRT: what a queue's subtrees are chosen by
  sah,                                                 // their expected cost for random rays
  pilot,                                               // the cost measured in a small frame
  dynamic  // like pilot, and moved between a Renderer's frames by what the last one measured
};

enum class PixelGrid { centers, corners };  // corners: the outermost rays go through the picture's edges

// Of RenderOptions::adaptive_target: pictures about as good as of 16 samples in each pixel
// (docs/design/adaptive.md).
constexpr double kDefaultAdaptiveTarget = 0.0075;

// The default of RenderOptions::min_weight: half of an 8-bit step where sRGB's curve is steepest (slope
// 12.92, in the dark), since no smaller change shows in a PNG.
constexpr double kDefaultMinWeight = 0.5 / 255 / 12.92;

// Finished tiles of a picture, with their film's sums, in a folder: what a run that ends before its time
// leaves for the next one, and what several processes make one picture by (docs/design/checkpoint.md).
struct LedgerOptions {
  std::filesystem::path folder = {};  // made if need be
  // Goes on from what is there, which may be nothing; false: a checkpoint that is there is refused.
  bool resume = false;
  // Other processes may be at the same picture, on this machine or others that see the folder; implies
  // resume.
  bool share = false;
  double every_seconds = 10;  // what is finished is written so often, and at the end
  double lease_seconds = 5;   // a process that isn't heard of for so long has lost what it had in work
};

// A part of a picture, in pixels from its top left.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
};

struct RenderOptions {
  // 0: what the scene or its camera asks for, or 1024x1024; where one is given, the other follows from the
  // aspect ratio that these ask for, or 1.
  int width = 0, height = 0;
  // This part of the picture alone, with the pixels that the whole one has there, bit for bit. (Adaptive
  // sampling aims at the error of the part, and takes other samples for it.)
  std::optional<PixelRect> crop = {};
  int depth = 0;           // 0: what the scene asks for, or 5; the eye ray is depth 1
  double min_weight = -1;  // < 0: what the scene asks for, or kDefaultMinWeight; 0: no cut
  int samples = 0;         // per pixel, stratified; 0: what the scene asks for, or 1
  // > 0: as many samples in each pixel as an RMSE of that, in linear RGB, is believed to take.
  double adaptive_target = 0;
  PixelGrid grid = PixelGrid::centers;
  int tile_width = 0, tile_height = 0;  // 0: chosen
  Traversal traversal = Traversal::automatic;
  Precision precision = Precision::float32;
  Mode mode = Mode::automatic;
  Division division = Division::bag;
  Balance balance = Balance::pilot;
  int ray_buffer = 0;  // ODPRT: rays that a buffer between queues holds for each slice; 0: chosen
  // ODPRT: the most that a device may hold; subtrees come and go; 0: no limit.
  std::uint64_t device_memory = 0;
  bool timeline = false;  // keep what Renderer::timeline() tells
  std::vector<std::string> channels =
      {};  // of "depth", "normal", "primitive", "instance", "cost", "queue" and "samples"
  std::function<void(double)> progress = {};  // called from the calling thread with the share done, 0 to 1
  std::optional<Camera> camera = {};          // in place of the scene's
  std::optional<Cancel> cancel = {};
  std::optional<LedgerOptions> ledger = {};
};

}  // namespace kdray
