#include "bench/workload/scenes.h"

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "scene/generate/built_in.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/import/load.h"
#include "scene/model/frame.h"

namespace kdray::bench {

namespace {

constexpr std::string_view kDisplaced = "displaced:";
constexpr std::size_t kMostTriangles = 100000000;

struct Data {
  const char *name, *file;
  std::optional<scene::Camera> camera;  // of rooms: within
};

const std::vector<Data>& all_data() {
  static const std::vector<Data> all = {{"sponza", "interior/dabrovic_sponza/sponza.obj.xz",
                                         scene::Camera{.from = {14.4499, 6.89415, -1.18547},
                                                       .at = {13.4563, 6.78438, -1.15861},
                                                       .up = {-0.109708, 0.993957, 0.00374357},
                                                       .vertical_fov = glm::radians(74.0)}},
                                        {"conference", "interior/conference/conference.ply.xz",
                                         scene::Camera{.from = {1000, 300, -800},
                                                       .at = {-200, 100, 200},
                                                       .up = {0, 1, 0},
                                                       .vertical_fov = glm::radians(60.0)}},
                                        {"armadillo", "stanford/armadillo_86k.ply.xz", {}},
                                        {"dragon", "stanford/dragon_vrip.ply.xz", {}}};
  return all;
}

const Data* find_data(const std::string& name) {
  for (const Data& d : all_data())
    if (d.name == name) return &d;
  return nullptr;
}

// Empty where there is none.
std::filesystem::path file_of(const Data& data) {
  const char* const folder = std::getenv("KDRAY_DATA");
  if (folder == nullptr) return {};
  const std::filesystem::path file = std::filesystem::path(folder) / data.file;
  return std::filesystem::exists(file) ? file : std::filesystem::path();
}

std::filesystem::path required_file(const Data& data) {
  const std::filesystem::path file = file_of(data);
  if (file.empty())
    throw Error(ErrorCode::input,
                std::string(data.name) + ": the folder KDRAY_DATA has to have " + data.file);
  return file;
}

scene::Scene load_data(const Data& data) {
  scene::Scene scene = scene::load(required_file(data).string());
  scene.name = data.name;
  if (data.camera) {
    scene.camera = *data.camera;
    const DBox box = scene.bounds();
    scene.lights = {{}};  // high up in the middle
    scene.lights[0].position = (box.lo + box.hi) * 0.5 + dvec3(0, 0.3, 0) * box.extent();
  }
  return scene;
}

// Of "displaced:50000"; throws for what is no such number.
std::size_t n_displaced(const std::string& name) {
  std::size_t n = 0;
  const char *const first = name.data() + kDisplaced.size(), *const last = name.data() + name.size();
  const auto [end, error] = std::from_chars(first, last, n);
  if (error != std::errc() || end != last || n < 100 || n > kMostTriangles)
    throw Error(ErrorCode::input,
                name + ": a number of triangles from 100 to 100000000 belongs behind the colon");
  return n;
}

scene::Scene displaced(const std::string& name) {
  scene::Scene scene = generate::displaced_sphere_of(n_displaced(name));
  scene.name = name;
  scene::frame_scene(scene);
  return scene;
}

}  // namespace

scene::Scene load_scene(const std::string& name) {
  if (name == "meadow") return meadow();
  if (name.starts_with(kDisplaced)) return displaced(name);
  if (const Data* const data = find_data(name)) return load_data(*data);
  return generate::load_scene(name);
}

void require_scene(const std::string& name) {
  if (name == "meadow") return;
  if (name.starts_with(kDisplaced)) return void(n_displaced(name));
  if (const Data* const data = find_data(name)) return void(required_file(*data));
  generate::require_scene(name);
}

DataNames data_scenes() {
  DataNames names;
  for (const Data& d : all_data()) (file_of(d).empty() ? names.missing : names.here).emplace_back(d.name);
  return names;
}

}  // namespace kdray::bench
