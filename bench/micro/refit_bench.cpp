// What    A mesh that is bent by up to a tenth of its size: commits that refit against commits that build,
//         and rays over either, in turn. Prints medians as a table; hits of both are compared bit for bit.
// Shape   refit_bench [subdivisions] [rounds] [rays] [bend] [degrees]: the displaced sphere of
//         generate/displaced_sphere.h (700 has a million triangles). Each round bends it otherwise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "bench/measure/stopwatch.h"
#include "bench/workload/arrays.h"
#include "kdray/kdray.h"
#include "scene/generate/displaced_sphere.h"

namespace kdray {
namespace {

// A mesh of radius 1, so a tenth of its size is 0.2. It is turned first, about the diagonal.
std::vector<double> bent(const std::vector<float>& from, double by, double degrees, double phase) {
  const dmat4 turn = glm::rotate(dmat4(1), glm::radians(degrees), glm::normalize(dvec3(1, 1, 1)));
  std::vector<double> vertices;
  for (std::size_t i = 0; i < from.size(); i += 3) {
    const dvec3 v(turn * glm::dvec4(from[i], from[i + 1], from[i + 2], 1));
    vertices.insert(vertices.end(), {v.x, v.y, v.z});
  }
  std::vector<double> moved = vertices;
  for (std::size_t i = 0; i < moved.size(); i += 3) {
    moved[i] += by * std::sin(2 * vertices[i + 1] + phase);
    moved[i + 2] += by * std::cos(1.5 * vertices[i] - phase);
  }
  return moved;
}

struct Seconds {
  std::vector<double> wall, processor;

  void add(const bench::Stopwatch& watch) {
    wall.push_back(watch.wall());
    processor.push_back(watch.cpu());
  }
};

struct Side {
  Scene scene;
  Seconds commit, random, coherent;
  std::vector<double> t;
  std::vector<std::uint32_t> primitive;

  void ask(const Rays& rays, Seconds& seconds) {
    t.resize(rays.origins.size());
    primitive.resize(t.size());
    const bench::Stopwatch watch;
    scene.closest(rays, {.t = t, .primitive = primitive});
    seconds.add(watch);
  }
};

struct RaySet {
  std::vector<float> origins, directions;
  Rays rays() const { return {origins, directions}; }
};

RaySet random_rays(std::size_t n) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  RaySet rays;
  for (std::size_t i = 0; i < 3 * n; ++i) {
    rays.origins.push_back(0.8f * normal(random));
    rays.directions.push_back(normal(random));
  }
  return rays;
}

RaySet picture_rays(std::size_t n) {
  RaySet rays;
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(n)));
  for (std::size_t y = 0; y < side; ++y)
    for (std::size_t x = 0; x < side; ++x) {
      const auto at = [&](std::size_t i) {
        return 1.4f * (2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(side) - 1);
      };
      rays.origins.insert(rays.origins.end(), {0, 0, 5});
      rays.directions.insert(rays.directions.end(), {at(x), at(y), -5});
    }
  return rays;
}

std::string row(const char* what, const Seconds& built, const Seconds& refitted) {
  const double a = median(built.wall), b = median(refitted.wall);
  return fmt::format("{:<16} build {:8.2f} ms   refit {:8.2f} ms   refit/build {:.3f}   processor {:.3f}\n",
                     what, 1e3 * a, 1e3 * b, b / a, median(refitted.processor) / median(built.processor));
}

int run(std::uint32_t n, int rounds, std::size_t n_rays, double by, double degrees) {
  const bench::MeshArrays mesh = bench::mesh_of(generate::displaced_sphere(n), "sphere");
  Side built, refitted;
  for (Side* side : {&built, &refitted}) {
    side->scene.add_mesh({mesh.vertices, mesh.triangles});
    side->scene.commit({});
  }
  const RaySet random = random_rays(n_rays), picture = picture_rays(n_rays);
  fmt::print("{} triangles, bent by {}, turned by {} degrees\n", mesh.triangles.size() / 3, by, degrees);
  std::size_t differ = 0;
  const auto compare = [&] {
    for (std::size_t i = 0; i < built.t.size(); ++i)
      differ += built.t[i] != refitted.t[i] || built.primitive[i] != refitted.primitive[i];
  };
  double growth = 0, first = 0;
  for (int round = -1; round < rounds; ++round) {
    const std::vector<double> moved = bent(mesh.vertices, by, degrees, 0.7 * round);
    for (Side* side : {&built, &refitted}) {
      const bench::Stopwatch watch;
      side->scene.update_vertices(0, moved);
      const CommitReport report = side->scene.commit({.refit_growth = side == &built ? 0.0 : 100.0});
      side->commit.add(watch);
      if (side == &refitted) growth = std::max(growth, report.growth);
    }
    if (round < 0) first = refitted.commit.wall.front();
    Seconds warm;
    for (Side* side : {&built, &refitted}) side->ask(picture.rays(), warm);
    for (Side* side : {&built, &refitted}) side->ask(random.rays(), side->random);
    compare();
    for (Side* side : {&built, &refitted}) side->ask(picture.rays(), side->coherent);
    compare();
    if (round < 0)
      for (Side* side : {&built, &refitted}) side->commit = {}, side->random = {}, side->coherent = {};
  }
  fmt::print("first refit {:.1f} ms; growth {:.3f}; {} hits differ\n", 1e3 * first, growth, differ);
  fmt::print("{}{}{}", row("update+commit", built.commit, refitted.commit),
             row("random rays", built.random, refitted.random),
             row("picture's rays", built.coherent, refitted.coherent));
  return differ == 0 ? 0 : 1;
}

}  // namespace
}  // namespace kdray

int main(int n, char** arguments) {
  const auto argument = [&](int i, double otherwise) { return n > i ? std::atof(arguments[i]) : otherwise; };
  return kdray::run(static_cast<std::uint32_t>(argument(1, 700)), static_cast<int>(argument(2, 7)),
                    static_cast<std::size_t>(argument(3, 1 << 20)), argument(4, 0.2), argument(5, 0));
}
