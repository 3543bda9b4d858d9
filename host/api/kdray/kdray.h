// What    kdray's public C++ interface: load a scene, build its tree on a device, render pictures, trace rays.
//         `kdray`, the command line, is one client of it; an installed kdray offers it as kdray::kdray to CMake.
// Shape   Only standard types cross this header. Classes are handles: cheap to move, not copyable.
// Errors  Everything throws kdray::Error (base/error.h's codes: 1 input, 2 usage, 3 no device, 4 out of memory).
// Threads A Renderer serves one call at a time; different Renderers may be used from different threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kdray/error.h"

namespace kdray {

namespace scene {
struct Scene;  // the full model, for kdray's own rooms
}

// A scene read from a file (formats: see docs/scenes.md).
class Scene {
 public:
  static Scene load(const std::filesystem::path& file);
  explicit Scene(scene::Scene&& model);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  std::uint32_t primitives() const;
  const std::vector<std::string>& warnings() const;  // what the loader left out or changed, one line each
  const scene::Scene& model() const;

 private:
  std::unique_ptr<scene::Scene> model_;
};

struct TreeOptions {
  int max_depth = -1;  // -1: 8 + 1.3*log2(N)
  double cost_traverse = 1.0;
  double cost_intersect =
      3.0;  // of one test: of a primitive, or of a block of them where the tree is built for blocks
  double empty_bonus = 0.6;
};

struct DeviceOptions {
  std::string device = "auto";  // "auto", "cpu", "gpu", a number from `kdray devices`, or a part of a name
  int queues = 1;               // one per sub-device of equal size when > 1
  int work_group = 0;           // local size of the per-ray kernels; 0: chosen for the device
  int compute_units = 0;        // that many of the device's, as a sub-device; 0: all of them
};

// How rays find their way through the tree. A choice changes time, never a hit (docs/design/traversal.md).
enum class Traversal {
  automatic,  // per 16 rays, from how coherent they are
  binary,     // the binary tree, one ray per work-item: the baseline
  wide,       // the wide tree, one ray per work-item
  packet,     // the wide tree, 16 coherent rays to a vector, several packets in flight
  batch       // the wide tree, many independent rays in flight
};

enum class PixelGrid { centers, corners };  // corners: the outermost rays go through the picture's edges

struct RenderOptions {
  int width = 0, height = 0;  // 0: what the scene asks for, or 1024x1024
  int depth = 0;              // 0: what the scene asks for, or 5; the eye ray is depth 1
  double min_weight = -1;     // < 0: what the scene asks for, or the default; 0: no cut
  int samples = 0;            // per pixel, stratified; 0: what the scene asks for, or 1
  PixelGrid grid = PixelGrid::centers;
  int tile_width = 0, tile_height = 0;  // 0: chosen
  Traversal traversal = Traversal::automatic;
  std::vector<std::string> channels = {};     // of "depth", "normal", "primitive", "cost"
  std::function<void(double)> progress = {};  // called from the calling thread with the share done, 0 to 1
};

struct Channel {
  std::string name;           // "depth", "normal.x" "normal.y" "normal.z", "primitive", "cost"
  std::vector<float> values;  // width * height
};

struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgb;  // linear, 3 * width * height, from the top left
  std::vector<Channel> channels;
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

class Renderer {
 public:
  explicit Renderer(const Scene& scene, const TreeOptions& tree = {}, const DeviceOptions& device = {});
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  Picture render(const RenderOptions& options = {});

  // Hits in the order of the rays. `repeat` > 1 traces that often and reports the median time in statistics().
  // A ray with NaN or infinite origin, or a direction that is not finite or 0, is refused (ErrorCode::input).
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit = false, int repeat = 1,
                         Traversal traversal = Traversal::automatic);

  // JSON: seconds, rays, tree, memory, features, device, mode of what has been done so far (DESIGN.md section 2).
  std::string statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct DeviceInfo {
  int number = 0;
  std::string name, platform, version, driver, kind;  // kind: "cpu", "gpu", "accelerator"
  std::uint32_t compute_units = 0;
  std::uint64_t global_memory = 0, max_allocation = 0;
  std::string vectors;  // the form of the kernels' vector operations: "x86 AVX-512" or "portable"
  bool usable = true;
  std::string why_not;  // when not usable
};

// All OpenCL devices; empty when there is no platform. Never throws for want of a device.
std::vector<DeviceInfo> devices();

}  // namespace kdray
