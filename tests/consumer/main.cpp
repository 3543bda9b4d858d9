// What    Uses the installed kdray as any program would: loads a scene, renders it, traces a ray.
// Errors  Status 1, with a line, at the first wrong answer. Without a device: says so, status 0.
#include <kdray/kdray.h>

#include <cmath>
#include <cstdio>

namespace {

int failures = 0;

void expect(bool good, const char* what) {
  if (!good) std::fprintf(stderr, "wrong: %s\n", what), ++failures;
}

// A picture of its size, with something in front of the background.
void check_picture(kdray::Renderer& renderer) {
  kdray::RenderOptions options;
  options.width = options.height = 32;
  const kdray::Picture picture = renderer.render(options);
  expect(picture.width == 32 && picture.height == 32, "the picture's size");
  expect(picture.rgb.size() == 3 * 32 * 32, "the picture's values");
  if (picture.rgb.size() != 3 * 32 * 32) return;
  int n_unlike_first = 0;
  for (std::size_t i = 3; i < picture.rgb.size(); i += 3)
    n_unlike_first += std::abs(picture.rgb[i] - picture.rgb[0]) > 0.01f;
  expect(n_unlike_first > 100, "more than one colour");
}

// Straight down from above the middle of the plane, clear of the balls: the plane z = -0.5 is 8.5 below; and
// the same ray upwards, which meets nothing.
void check_rays(kdray::Renderer& renderer) {
  const kdray::Ray rays[] = {{{9, 9, 8}, 0, {0, 0, -2}, INFINITY}, {{9, 9, 8}, 0, {0, 0, 1}, INFINITY}};
  const std::vector<kdray::Hit> hits = renderer.trace(rays);
  expect(hits.size() == 2, "a hit per ray");
  if (hits.size() != 2) return;
  expect(std::abs(hits[0].t - 4.25f) < 1e-4f, "the distance to the plane");
  expect(hits[0].primitive == 0 || hits[0].primitive == 1, "a triangle of the plane");
  expect(std::isinf(hits[1].t) && hits[1].primitive == -1, "a miss");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const kdray::Scene scene = kdray::Scene::load(argc > 1 ? argv[1] : "balls.nff");
    expect(scene.primitives() > 800, "the number of primitives");
    kdray::Renderer renderer(scene);
    check_picture(renderer);
    check_rays(renderer);
  } catch (const kdray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    if (error.code() != kdray::ErrorCode::no_device) return 1;
    std::puts("no OpenCL device: skipped");
    return 0;
  }
  std::puts(failures == 0 ? "consumer: all right" : "consumer: wrong answers");
  return failures == 0 ? 0 : 1;
}
