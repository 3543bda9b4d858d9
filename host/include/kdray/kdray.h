// What    kdray's public C++ interface: a scene from a file or from a program's arrays (kdray/scene.h), its
//         tree on a device, pictures, rays. `kdray`, the command line, is one client of it; an installed
//         kdray offers it as kdray::kdray to CMake.
// Shape   Only standard types cross this header. Classes are handles: cheap to move, not copyable.
// Errors  Everything throws kdray::Error (kdray/error.h's codes: 1 input, 2 usage, 3 no device, 4 out of
//         memory, 6 cancelled), and std::bad_alloc where the process has no memory left.
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

#include "kdray/device_info.h"
#include "kdray/error.h"
#include "kdray/options.h"
#include "kdray/ray.h"
#include "kdray/scene.h"
#include "kdray/statistics.h"

namespace kdray {

// Where a picture is seen from, and before what, in place of what the scene says. What isn't given stays as
// it is; where the file has no camera, it is chosen so that all is in the picture, and so are lights where it
// has none.
struct View {
  using Vector = std::array<double, 3>;
  std::optional<int> camera = {};  // of those that the file has, from 0
  std::optional<Vector> from = {}, at = {}, up = {};
  // The way from the scene's middle to a camera that shows all of it, in place of the file's, with y up.
  std::optional<Vector> side = {};
  std::optional<double> fov = {};  // of the picture's full height, in degrees
  // An orthographic camera: the picture's width in the scene's units; 0: as wide as the scene needs.
  std::optional<double> ortho_width = {};
  std::optional<double> aperture = {}, focus = {};  // of a thin lens: its diameter, and what it shows sharp
  std::optional<std::array<float, 3>> background = {};  // linear RGB
  double headlight = 0;  // above 0: one more light, of this strength, at the camera
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
  // The same as a further frame of a film: what was made up for its first frame (settings() of that, seen by
  // the same view) is taken over in place of a camera, lights and a glTF file's exposure of its own.
  PreparedScene seen_after(const scene::Scene& first, const View& view, int width = 0, int height = 0) const;
  // The same scene in a studio, where its file has neither camera nor lights, or `instead` of these: from
  // then on seen() chooses a camera that shows it well, soft lights that follow it, a backdrop and a floor
  // (docs/scenes.md), as far as the view leaves them open.
  PreparedScene in_studio(bool instead = false) const;
  // The same shapes, white and shining on black: a picture of depth 1 is what share of each pixel they cover.
  PreparedScene coverage() const;
  // The same shapes, black before the scene's background: a picture of depth 1 is what eye rays bring from
  // the background into each pixel.
  PreparedScene backdrop() const;
  const prepare::Prepared& prepared() const { return *prepared_; }

 private:
  std::shared_ptr<const prepare::Prepared> prepared_;
};

// Throws what PreparedScene::seen() would, for a scene that isn't prepared yet.
void check_view(const scene::Scene& scene, const View& view);

class SceneCache {
 public:
  explicit SceneCache(CacheOptions options) : options_(std::move(options)) {}

  // $KDRAY_CACHE_DIR, $XDG_CACHE_HOME/kdray/scenes or ~/.cache/kdray/scenes; empty where there is no home, or
  // where KDRAY_CACHE_DIR is set to nothing.
  static std::filesystem::path default_folder();

  // The scene as it was kept, if no file that it was made of and no option has changed since. An entry that
  // is damaged counts as none.
  std::optional<PreparedScene> find(const std::filesystem::path& file, const TreeOptions& tree = {},
                                    const LoadOptions& load = {}) const;

  // Whether it was kept: not a scene that comes from no file, takes more than a quarter of max_bytes, or less
  // than min_bytes. Throws ErrorCode::input when the folder can't be written.
  bool keep(const PreparedScene& scene) const;

 private:
  CacheOptions options_;
};

struct Channel {
  // "depth", "normal.x" "normal.y" "normal.z", "primitive", "instance", "cost", "queue", "samples"
  std::string name;
  std::vector<float> values;  // width * height
};

struct Picture {
  int width = 0, height = 0;  // of the part that RenderOptions::crop asks for, or of the whole picture
  std::vector<float> rgb;     // linear, 3 * width * height, from the top left
  std::vector<Channel> channels;
  // What went wrong on the way, one line each: the picture is right all the same.
  std::vector<std::string> warnings;
  int x = 0, y = 0, whole_width = 0, whole_height = 0;  // where it lies, in a picture of that size
};

// Whether rays of these options walk the tree's binary form, so that TreeOptions::binary_form is to be left
// true.
bool takes_binary_form(Traversal traversal, Precision precision, std::span<const std::string> channels = {});

namespace api {
struct HookedRenderer;  // for kdray's own tests and benches
}

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
  // (ErrorCode::input). Where the scene has instances, `instances` gets of each closest hit the place in the
  // scene's list of the one that it lies in, or kNoInstance, and a hit in one has its mesh's primitive; else
  // it gets nothing.
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit = false, int repeat = 1,
                         Traversal traversal = Traversal::automatic, Precision precision = Precision::float32,
                         std::vector<std::uint32_t>* instances = nullptr);

  // The scene as it is seen otherwise, from the next frame on: what seen() made of the scene that this
  // Renderer was made of. Takes no time, and the tree, the devices and what frames have told of costs are
  // kept.
  void look(const PreparedScene& seen);

  // From the next call on, in place of what was found in DeviceOptions::tunings. Forgets what former frames
  // told of tiles.
  void tune(const Tuning& tuning);

  // What the queues did in the last frame, one row each: JSON in the Chrome trace format.
  // RenderOptions::timeline asks for it.
  std::string timeline() const;

  // Figures of what has been done so far; to_json() makes text of them.
  const Statistics& statistics() const;

 private:
  friend struct api::HookedRenderer;
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// JSON, by the names of docs/statistics.md.
std::string to_json(const Statistics& statistics);

// Wall time.
struct OpenSeconds {
  double start = 0, self_test = 0;  // as in Statistics::Seconds
};

// Throws ErrorCode::no_device where DeviceOptions::device names none that there is. Opens nothing, and tries
// nothing, so a device that it finds may still be refused.
void require_device(const DeviceOptions& device);

// Opens the device that a Renderer of these options will use, which takes a while and can be done beside the
// loading of a scene, by another thread. It stays open until the process ends. Throws what the Renderer
// would.
OpenSeconds open_device(const DeviceOptions& device);

// Beside SceneCache::default_folder(), or in $KDRAY_CACHE_DIR; empty where that is.
std::filesystem::path default_program_folder();

// Writes the programs that were built into DeviceOptions::programs, for later processes; takes as long as a
// build, so best when the picture is out. A folder that can't be written is no error.
void keep_programs(const DeviceOptions& device);

// A program, or a few that are used together, that warm_up() looked for.
struct WarmProgram {
  std::string device, what;
  double seconds = 0;     // to find it, or to compile and keep it
  bool compiled = false;  // it was not there
};

// Compiles beforehand what frames in PDPRT and queries, both with the walk chosen by itself, need of nearly
// any scene, and keeps it in DeviceOptions::programs: from then on they wait for no compiler there
// (docs/design/start.md). Takes half a minute or more where nothing is there yet; `told` hears of each
// program. What only trees of more than `largest` bytes take is left out. Throws ErrorCode::input where
// nothing can be kept, ErrorCode::usage where no folder is named.
std::vector<WarmProgram> warm_up(const DeviceOptions& device,
                                 const std::function<void(const WarmProgram&)>& told = {},
                                 std::uint64_t largest = ~std::uint64_t{0});

// All OpenCL devices; empty when there is no platform. Never throws for want of a device. A device that fails
// the self-test is not usable; of the options, those on built programs count, and left_out, which is told of
// drivers that can't be asked for their devices.
std::vector<DeviceInfo> devices(const DeviceOptions& options = {});

}  // namespace kdray
