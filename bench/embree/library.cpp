#include "bench/embree/library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <vector>

#include "base/error.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define KDRAY_HAS_SANITIZER
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define KDRAY_HAS_SANITIZER
#endif

namespace kdray::bench::embree {

namespace {

// Embree and what it is linked with find their own symbols first: two Embrees have the same names, and one of
// a Python package brings a TBB along. Sanitizers refuse that.
#if defined(KDRAY_HAS_SANITIZER)
constexpr int kMode = RTLD_NOW | RTLD_LOCAL;
#else
constexpr int kMode = RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND;
#endif

class Loader {
 public:
  Loader(void* handle, std::string file) : handle_(handle), file_(std::move(file)) {}

  template <class F>
  void optional(F& function, const std::string& name) const {
    function = reinterpret_cast<F>(dlsym(handle_, ("rtc" + name).c_str()));
  }
  template <class F>
  void required(F& function, const std::string& name) const {
    optional(function, name);
    if (function == nullptr)
      throw Error(ErrorCode::input, fmt::format("{}: no Embree: it has no rtc{}", file_, name));
  }

 private:
  void* handle_;
  std::string file_;
};

void load_functions(const Loader& from, Library& e) {
  from.required(e.new_device, "NewDevice");
  from.required(e.release_device, "ReleaseDevice");
  from.required(e.get_device_error, "GetDeviceError");
  from.required(e.get_device_property, "GetDeviceProperty");
  from.required(e.new_scene, "NewScene");
  from.required(e.release_scene, "ReleaseScene");
  from.required(e.set_scene_flags, "SetSceneFlags");
  from.required(e.set_scene_build_quality, "SetSceneBuildQuality");
  from.required(e.attach_geometry_by_id, "AttachGeometryByID");
  from.required(e.commit_scene, "CommitScene");
  from.required(e.new_geometry, "NewGeometry");
  from.required(e.release_geometry, "ReleaseGeometry");
  from.required(e.commit_geometry, "CommitGeometry");
  from.required(e.set_shared_geometry_buffer, "SetSharedGeometryBuffer");
  from.required(e.set_geometry_occluded_filter_function, "SetGeometryOccludedFilterFunction");
  from.required(e.set_geometry_instanced_scene, "SetGeometryInstancedScene");
  from.required(e.set_geometry_transform, "SetGeometryTransform");
  from.required(e.point_query, "PointQuery");
  constexpr const char* kWidths[] = {"1", "8", "16"};
  for (int i = 0; i < 3; ++i) {
    from.required(e.intersect[i], std::string("Intersect") + kWidths[i]);
    from.required(e.occluded[i], std::string("Occluded") + kWidths[i]);
  }
  from.optional(e.intersect_nm, "IntersectNM");
  from.optional(e.occluded_nm, "OccludedNM");
}

Library load(void* handle, const std::string& file) {
  Library e{};
  load_functions(Loader(handle, file), e);
  const auto version = e.get_device_property(OpenDevice(e).get(), DeviceProperty::version);
  e.major = static_cast<int>(version / 10000);
  e.version = fmt::format("{}.{}.{}", e.major, version / 100 % 100, version % 100);
  if ((e.major != 3 && e.major != 4) || (e.major == 3 && e.intersect_nm == nullptr))
    throw Error(ErrorCode::input,
                fmt::format("{}: Embree {}; kdray knows how versions 3 and 4 are called", file, e.version));
  return e;
}

std::vector<std::string> named_files() {
  std::vector<std::string> files;
  const char* const named = std::getenv("KDRAY_EMBREE");
  for (std::string_view rest = named ? named : ""; !rest.empty();) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) files.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return files;
}

std::vector<Library> find_libraries() {
  std::map<int, Library> found;
  const auto look_for = [&](const std::string& file) {
    void* const handle = dlopen(file.c_str(), kMode);
    if (handle == nullptr) return false;
    Library e = load(handle, file);
    found[e.major] = std::move(e);
    return true;
  };
  for (const char* const file : {"libembree3.so.3", "libembree4.so.4"}) look_for(file);
  for (const std::string& file : named_files())
    if (!look_for(file)) throw Error(ErrorCode::input, fmt::format("KDRAY_EMBREE: {}", dlerror()));
  std::vector<Library> all;
  for (auto& [major, library] : found) all.push_back(std::move(library));
  return all;
}

}  // namespace

std::span<const Library> libraries() {
  static const std::vector<Library> found = find_libraries();
  return found;
}

OpenDevice::OpenDevice(const Library& library)
    : library_(library), device_(library.new_device("frequency_level=simd512")) {
  if (device_ == nullptr) throw Error(ErrorCode::internal, "Embree gives no device");
}

}  // namespace kdray::bench::embree
