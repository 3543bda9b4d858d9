// What    Rays from outside that floats can't hold in the scene's own space as they are: those that begin
//         over 2^60 times the scene's size away, and all rays where the scene's size itself is beyond what a
//         float can be multiplied by. They are begun anew where they come nearest to the scene's centre, in
//         double.
// Shape   NearRays says which space and which rays a kernel is to be given, and turns the distances it
//         answers back. Rays that need none of this stay as they are, where they are: that is what it is
//         for. Rays of any other arrays are moved to the scene's own space one by one (local_rays.h).
// Errors  A ray that passes the scene by at over 2^60 times its size meets nothing.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/local_space.h"
#include "kdray/ray.h"

namespace kdray::query {

// Rays that begin beyond so many local lengths are begun anew; its square is a float still.
inline constexpr double kFar = 0x1p60;

class NearRays {
 public:
  explicit NearRays(const LocalSpace& space);

  // The space that the kernels take rays from; its centre and scale are floats.
  const LocalSpace& kernel_space() const { return kernel_space_; }

  // Whether rays none of whose origins has a larger coordinate can stay as they are.
  bool all_near(float farthest) const { return farthest <= limit_; }

  // The rays to trace: `rays` themselves, unless one of them is too far off. Valid until the next call.
  std::span<const Ray> take(std::span<const Ray> rays);

  // Turns the distances of the hits of the rays that were taken last back to theirs.
  void give_back(std::span<Hit> hits) const;

  // Whether any of the rays that were taken last was begun anew, and what a distance of the i-th then is.
  bool has_moved() const { return !ahead_.empty(); }
  float given_back(std::size_t i, float t) const { return static_cast<float>(t / shrink_ + ahead_[i]); }

 private:
  bool is_far(const Ray& ray) const;
  Ray begin_near(const Ray& ray, double& ahead) const;

  LocalSpace space_, kernel_space_;
  double shrink_;  // the kernels' world is so many times as large as the rays'
  float limit_;    // a ray whose origin has a coordinate beyond this is far
  std::vector<Ray> rays_;
  std::vector<double> ahead_;  // of each ray, how far ahead it was begun anew; none: all stayed as they are
};

}  // namespace kdray::query
