// What    The Embrees that are there: shared libraries that are found when kdray runs, of version 3 and of
//         version 4, in one process.
// Shape   Looked for: libembree3.so.3 and libembree4.so.4 where the loader finds them (Debian's libembree3-3
//         or libembree4-4), and the files that the variable KDRAY_EMBREE names, with colons between. Of one
//         major version the last one found counts.
// Errors  A file in KDRAY_EMBREE that is no Embree of version 3 or 4 is ErrorCode::input. One that the loader
//         doesn't find is just not there.
#pragma once

#include <span>
#include <string>

#include "bench/embree/layout.h"

namespace kdray::bench::embree {

// Functions by Embree's names, without rtc.
struct Library {
  int major = 0;        // 3 or 4
  std::string version;  // "4.4.0"

  Device (*new_device)(const char* config);
  void (*release_device)(Device);
  int (*get_device_error)(Device);  // 0: none since the last call
  std::ptrdiff_t (*get_device_property)(Device, DeviceProperty);

  Scene (*new_scene)(Device);
  void (*release_scene)(Scene);
  void (*set_scene_flags)(Scene, SceneFlags);
  void (*set_scene_build_quality)(Scene, BuildQuality);
  void (*attach_geometry_by_id)(Scene, Geometry, unsigned id);
  void (*commit_scene)(Scene);

  Geometry (*new_geometry)(Device, GeometryType);
  void (*release_geometry)(Geometry);
  void (*commit_geometry)(Geometry);
  void (*set_shared_geometry_buffer)(Geometry, BufferType, unsigned slot, Format, const void* data,
                                     std::size_t offset, std::size_t stride, std::size_t n);
  void (*set_geometry_occluded_filter_function)(Geometry, Filter);
  void (*set_geometry_instanced_scene)(Geometry, Scene);
  void (*set_geometry_transform)(Geometry, unsigned time_step, Format, const void* transform);
  bool (*point_query)(Scene, PointQuery*, PointContext*, PointFunction, void* user);

  // Of 1, 8 and 16 rays; query.h knows what each version takes.
  using Function = void (*)();
  Function intersect[3], occluded[3];
  // Of version 3 alone; null in version 4.
  void (*intersect_nm)(Scene, Context*, void* rays, unsigned n, unsigned packets, std::size_t stride);
  void (*occluded_nm)(Scene, Context*, void* rays, unsigned n, unsigned packets, std::size_t stride);
};

// In order of their versions; loaded once.
std::span<const Library> libraries();

// A device with vectors as wide as the processor has. Throws ErrorCode::internal where Embree gives none.
class OpenDevice {
 public:
  explicit OpenDevice(const Library& library);
  ~OpenDevice() { library_.release_device(device_); }
  OpenDevice(const OpenDevice&) = delete;
  OpenDevice& operator=(const OpenDevice&) = delete;

  const Library& library() const { return library_; }
  Device get() const { return device_; }

 private:
  const Library& library_;
  Device device_;
};

}  // namespace kdray::bench::embree
