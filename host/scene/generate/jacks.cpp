// What    jacks: three crossed rods with a ball at each end, and half as large jacks in the eight octants
//         between.
// Shape   Size n: (8^n - 1) / 7 jacks of 3 cones and 6 spheres; 1 light.
// Source  The SPD package (A. Enzmann).
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/rotation.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

namespace {

constexpr double kReach = 0.75;  // of the arms in their cell, so that jacks keep apart
constexpr double kRod = 0.1, kBall = 0.2;

class Jacks {
 public:
  explicit Jacks(NffWriter& nff) : nff_(nff), frame_(rotation_x(-30 * kDegree) * rotation_y(-20 * kDegree)) {}

  void write(int levels, const dvec3& center, double scale) {
    write_one(center, kReach * scale);
    if (levels == 1) return;
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5})
        for (const double z : {-0.5, 0.5})
          write(levels - 1, center + frame_ * (scale * dvec3(x, y, z)), scale / 2);
  }

 private:
  static constexpr double kDegree = std::numbers::pi / 180;

  void write_one(const dvec3& center, double scale) {
    for (int i = 0; i < 3; ++i)
      nff_.cone(center - scale * frame_[i], scale * kRod, center + scale * frame_[i], scale * kRod);
    for (const double side : {1.0, -1.0})
      for (int i = 0; i < 3; ++i) nff_.sphere(center + side * scale * frame_[i], scale * kBall);
  }

  NffWriter& nff_;
  dmat3 frame_;  // its columns are the arms
};

}  // namespace

void write_jacks(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background({0.2, 0.05, 0.2});
  nff.view({.from = {0, 0, -8},
            .at = {0, 0, 0},
            .up = {0, 1, 0},
            .angle = 25,
            .hither = 0.001,
            .resolution = 256});
  nff.light({-10, 3, -20});
  nff.surface(
      {.color = {0.737, 0.561, 0.561}, .diffuse = 0.7, .specular = 0.7, .shine = 11.1434, .index = 1});
  Jacks(nff).write(size, {0, 0, 0}, 1);
}

}  // namespace kdray::generate
