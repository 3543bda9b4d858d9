// What    A picture of a scene that never was a file: a ring of mirroring balls on a floor, seen from two
//         sides.
// Use     picture OUT.ppm
// Errors  Status 1, with kdray's line.
#include <kdray/kdray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace {

kdray::Scene make_scene() {
  kdray::Scene scene;
  const kdray::MaterialId floor = scene.add_material({.diffuse = {0.6f, 0.6f, 0.55f}});
  const kdray::MaterialId mirror = scene.add_material({.diffuse = {0.2f, 0.25f, 0.3f},
                                                       .specular = {0.5f, 0.5f, 0.5f},
                                                       .reflect = {0.6f, 0.6f, 0.6f},
                                                       .shine = 60});
  const double corners[] = {-9, -9, 0, 9, -9, 0, 9, 9, 0, -9, 9, 0};
  const int triangles[] = {0, 1, 2, 0, 2, 3};
  scene.add_mesh({corners, triangles}, {.name = "floor", .material = floor});
  std::vector<double> centers;
  constexpr int kBalls = 12;
  for (int i = 0; i < kBalls; ++i) {
    const double turn = 2 * 3.14159265358979 * i / kBalls;
    centers.insert(centers.end(), {4 * std::cos(turn), 4 * std::sin(turn), 1});
  }
  scene.add_spheres({centers, std::array{0.95}}, {.name = "balls", .material = mirror});
  scene.add_light({.position = {6, -8, 12}, .color = {0.8f, 0.8f, 0.8f}});
  scene.add_light({.position = {-7, -3, 9}, .color = {0.3f, 0.3f, 0.35f}});
  scene.set_background({0.25f, 0.35f, 0.5f});
  return scene;
}

void write_ppm(const kdray::Picture& picture, const char* file) {
  std::ofstream out(file, std::ios::binary);
  out << "P6\n" << picture.width << ' ' << picture.height << "\n255\n";
  for (const float value : picture.rgb)
    out.put(static_cast<char>(std::lround(255 * std::pow(std::clamp(value, 0.0f, 1.0f), 1 / 2.2f))));
  if (!out.flush()) throw kdray::Error(kdray::ErrorCode::input, std::string(file) + ": can't be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "use: picture OUT.ppm\n"), 2;
  try {
    kdray::Scene scene = make_scene();
    scene.commit();
    kdray::RenderOptions options;
    options.width = options.height = 256;
    options.camera = kdray::Camera{.from = {9, -11, 7}, .at = {0, 0, 0.5}, .up = {0, 0, 1}, .fov = 38};
    write_ppm(scene.render(options), argv[1]);
  } catch (const kdray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    if (error.code() != kdray::ErrorCode::no_device) return 1;
    std::puts("no OpenCL device: skipped");
  }
  return 0;
}
