// What    kdray's public C++ interface: load a scene, build its tree on a device, render pictures, trace
//         rays. `kdray`, the command line, is one client of it; an installed kdray offers it as kdray::kdray
//         to CMake.
// Shape   Only standard types cross this header. Classes are handles: cheap to move, not copyable.
// Errors  Everything throws kdray::Error (base/error.h's codes: 1 input, 2 usage, 3 no device, 4 out of
//         memory).
// Threads A Renderer serves one call at a time; different Renderers may be used from different threads.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kdray/error.h"

namespace kdray {

// For kdray's own rooms.
namespace scene {
struct Scene;
}
namespace prepare {
struct Prepared;
}

// A scene read from a file (formats: see docs/scenes.md).
class Scene {
 public:
  static Scene load(const std::filesystem::path& file);
  // The same of a file's content; `name` tells its format by the ending, and where the files are that it
  // names.
  static Scene from_memory(std::string bytes, const std::filesystem::path& name);
  explicit Scene(scene::Scene&& model);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  std::uint32_t primitives() const;
  const std::vector<std::string>& warnings() const;  // what the loader left out or changed, one line each
  const scene::Scene& model() const;
  double load_seconds() const { return load_seconds_; }

 private:
  std::unique_ptr<scene::Scene> model_;
  double load_seconds_ = 0;
};

// How much time goes into the tree (docs/design/kdtree.md). A choice changes times and memory, never a hit.
enum class BuildQuality { fast, balanced, best };

struct TreeOptions {
  BuildQuality quality = BuildQuality::balanced;
  int max_depth = -1;  // -1: 8 + 1.3*log2(N)
  double cost_traverse = 1.0;
  double cost_intersect = 2.0;  // of one test: of a block of primitives
  // The most that the scene may take when it is traced; the tree gets coarser; 0: no limit.
  std::uint64_t memory_bytes = 0;
  bool binary_form = true;  // is made too; few options take it (takes_binary_form)
};

// Where a picture is seen from, and before what, in place of what the scene says. What isn't given stays as
// it is; where the file has no camera, it is chosen so that all is in the picture, and so are lights where it
// has none.
struct View {
  using Vector = std::array<double, 3>;
  std::optional<int> camera = {};  // of those that the file has, from 0
  std::optional<Vector> from = {}, at = {}, up = {};
  std::optional<double> fov = {};  // of the picture's full height, in degrees
  // An orthographic camera: the picture's width in the scene's units; 0: as wide as the scene needs.
  std::optional<double> ortho_width = {};
  std::optional<std::array<float, 3>> background = {};  // linear RGB
};

// A scene ready to be traced: its tree built, all in the form that a device uses. It keeps nothing of the
// Scene that it does not need; copies share what they hold.
class PreparedScene {
 public:
  explicit PreparedScene(const Scene& scene, const TreeOptions& tree = {});
  explicit PreparedScene(prepare::Prepared&& prepared);

  const std::vector<std::string>& warnings() const;
  const scene::Scene& settings() const;  // the scene without its primitives

  // The same scene seen otherwise, in a picture of this size (0: what the scene asks for, or square). Throws
  // ErrorCode::usage for a camera that isn't there, and for directions that make no view.
  PreparedScene seen(const View& view, int width = 0, int height = 0) const;
  // The same shapes, white and shining on black: a picture of depth 1 is what share of each pixel they cover.
  PreparedScene coverage() const;
  const prepare::Prepared& prepared() const { return *prepared_; }

 private:
  std::shared_ptr<const prepare::Prepared> prepared_;
};

// Throws what PreparedScene::seen() would, for a scene that isn't prepared yet.
void check_view(const scene::Scene& scene, const View& view);

// Prepared scenes kept in a folder between runs (docs/design/cache.md). Several processes and threads may use
// one at once.
struct CacheOptions {
  std::filesystem::path folder = {};  // made when something is to be kept; empty: there is no cache
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // of all scenes; the least recently used go first
  double min_seconds = 0.05;                         // what took less to load and build is not kept
};

class SceneCache {
 public:
  explicit SceneCache(CacheOptions options) : options_(std::move(options)) {}

  // $KDRAY_CACHE_DIR, $XDG_CACHE_HOME/kdray/scenes or ~/.cache/kdray/scenes; empty where there is no home, or
  // where KDRAY_CACHE_DIR is set to nothing.
  static std::filesystem::path default_folder();

  // The scene as it was kept, if no file that it was made of and no option has changed since. An entry that
  // is damaged counts as none.
  std::optional<PreparedScene> find(const std::filesystem::path& file, const TreeOptions& tree = {}) const;

  // Whether it was kept: not a scene that comes from no file, is larger than a quarter of max_bytes, or took
  // less than min_seconds. Throws ErrorCode::input when the folder can't be written.
  bool keep(const PreparedScene& scene) const;

 private:
  CacheOptions options_;
};

// How a device's work is cut into launches (docs/devices.md). A choice changes time, never the picture or a
// hit.
enum class Schedule {
  automatic,  // slices on CPUs, global elsewhere
  slices,     // a work-item takes a slice of the picture through all stages of many waves
  global      // a launch for each stage over all slices, one ray per work-item for tracing: for GPUs
};

// Settings that change time alone, never a bit of a picture or a hit; 0: kdray's own choice. `kdray tune`
// finds them, host/tune/ settings.cpp tells what each does.
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
  // For tests: "1@5,0@9" makes the fifth launch on queue 1 and the ninth on queue 0 fail as if the device
  // had; "self-test@0" makes device 0 fail the self-test.
  std::string faults = {};
  std::filesystem::path programs = {};  // folder where built programs are looked for and kept; empty: none
  // File of what `kdray tune` found; empty, or none there: what kdray ships with.
  std::filesystem::path tunings = {};
  // Told why, in a line, where that file is of no use.
  std::function<void(const std::string&)> tunings_ignored = {};
  // True: a compiler begins to work; false: it ends. From any thread; may nest.
  std::function<void(bool)> building = {};
  // Told of each device that "auto" would prefer, but can't use.
  std::function<void(const std::string&)> left_out = {};
  // For benches: what every kernel is compiled with beside kdray's own options.
  std::string build_options = {};
};

// How rays find their way through the tree. A choice changes time, never a hit (docs/traversal.md).
enum class Traversal {
  automatic,  // per 16 rays, from how coherent they are
  binary,     // the binary tree, one ray per work-item: the baseline
  wide,       // the wide tree, one ray per work-item
  packet,     // the wide tree, 16 coherent rays to a vector, several packets in flight
  batch       // the wide tree, many independent rays in flight
};

// What the kernels compute in. The scene is the same, stored as float. float64 (C++'s double) is the
// reference for float's
// rounding: slower, by the binary walk and PDPRT alone, on devices that have it.
enum class Precision { float32, float64 };

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

struct RenderOptions {
  int width = 0, height = 0;  // 0: what the scene asks for, or 1024x1024
  int depth = 0;              // 0: what the scene asks for, or 5; the eye ray is depth 1
  double min_weight = -1;     // < 0: what the scene asks for, or the default; 0: no cut
  int samples = 0;            // per pixel, stratified; 0: what the scene asks for, or 1
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
  // For benches: bits of kernels/layout/features.h and rules.h, what is compiled and done though the scene
  // doesn't need it.
  std::uint64_t keep = 0;
  bool timeline = false;                      // keep what Renderer::timeline() tells
  std::vector<std::string> channels = {};     // of "depth", "normal", "primitive", "cost", "samples"
  std::function<void(double)> progress = {};  // called from the calling thread with the share done, 0 to 1
};

struct Channel {
  std::string name;           // "depth", "normal.x" "normal.y" "normal.z", "primitive", "cost", "samples"
  std::vector<float> values;  // width * height
};

struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgb;  // linear, 3 * width * height, from the top left
  std::vector<Channel> channels;
  // What went wrong on the way, one line each: the picture is right all the same.
  std::vector<std::string> warnings;
};

struct Ray {
  float origin[3];
  float t_min;
  float direction[3];  // any length but 0; t counts in multiples of it
  float t_max;
};

struct Hit {
  float t;                 // inf: a miss; with any_hit 0: occluded
  std::int32_t primitive;  // number in file order; -1: a miss
  float u, v;  // triangle: barycentric weights of its 2nd and 3rd corner; cone: u = 0 base to 1 apex
};

// Whether rays of these options walk the tree's binary form, so that TreeOptions::binary_form is to be left
// true.
bool takes_binary_form(Traversal traversal, Precision precision, std::span<const std::string> channels = {});

class Renderer {
 public:
  explicit Renderer(const Scene& scene, const TreeOptions& tree = {}, const DeviceOptions& device = {});
  explicit Renderer(const PreparedScene& scene, const DeviceOptions& device = {});
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  Picture render(const RenderOptions& options = {});

  // Hits in the order of the rays. `repeat` > 1 traces that often and reports the median time in
  // statistics(). A ray with NaN or infinite origin, or a direction that is not finite or 0, is refused
  // (ErrorCode::input).
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit = false, int repeat = 1,
                         Traversal traversal = Traversal::automatic,
                         Precision precision = Precision::float32);

  // From the next call on, in place of what was found in DeviceOptions::tunings. Forgets what former frames
  // told of tiles.
  void tune(const Tuning& tuning);

  // What the queues did in the last frame, one row each: JSON in the Chrome trace format.
  // RenderOptions::timeline asks for it.
  std::string timeline() const;

  // JSON: seconds, rays, tree, memory, features, device and mode of what has been done so far
  // (docs/cli.md, "Statistics").
  std::string statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Opens the device that a Renderer of these options will use, which takes a while and can be done beside the
// loading of a scene, by another thread. It stays open until the process ends. Throws what the Renderer
// would.
void open_device(const DeviceOptions& device);

// Beside SceneCache::default_folder(), or in $KDRAY_CACHE_DIR; empty where that is.
std::filesystem::path default_program_folder();

// Writes the programs that were built into DeviceOptions::programs, for later processes; takes as long as a
// build, so best when the picture is out. A folder that can't be written is no error.
void keep_programs(const DeviceOptions& device);

struct DeviceInfo {
  int number = 0;
  std::string name, platform, version, driver, kind;  // kind: "cpu", "gpu", "accelerator"
  std::uint32_t compute_units = 0;
  std::uint64_t global_memory = 0, max_allocation = 0;
  std::string vectors;  // the form of the kernels' vector operations: "x86 AVX-512", "x86 AVX2" or "portable"
  std::string
      vectors_refused;  // the better forms that can't be had, each with why; empty where there is none
  bool double_precision = false;
  bool usable = true;
  std::string why_not;  // when not usable
};

// All OpenCL devices; empty when there is no platform. Never throws for want of a device. A device that fails
// the self-test is not usable; of the options, those on built programs and faults count.
std::vector<DeviceInfo> devices(const DeviceOptions& options = {});

}  // namespace kdray
