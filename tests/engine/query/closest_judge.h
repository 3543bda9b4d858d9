// What    Answers of closest_points() against exact arithmetic.
// Shape   judge() may be called from several threads. It expects the distance to be right to what is
//         promised, the primitive to be as close as that, of equally close ones the smallest number, and the
//         point to lie on it, as far away as it is said to be.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <string>

#include "engine/query/device_scene.h"
#include "engine/query/point_session.h"

namespace kdray::test {

struct Promise {
  double share, of_scene;  // of the distance, and of the scene's size
  double place;            // of the closest point, of the scene's size
};
inline constexpr Promise kInDoubles{0x1p-40, 0x1p-98, 0x1p-48}, kInPairsOfFloats{0x1p-36, 0x1p-28, 0x1p-19};

// Errors of distances, in units of a double's last place: how many are within each power of 4.
struct Errors {
  std::array<std::size_t, 16> within{};  // [k]: at most 4^k / 2
  double most_float_ulps = 0, most = 0;  // most: of the distance, as a share of it
  std::size_t n = 0, ties = 0;

  void add(double share, double float_ulps);
  void print(const std::string& name) const;
};

class Judge {
 public:
  Judge(const DeviceScene& queried, const Promise& promise) : asked_(queried), promise_(promise) {}

  void judge(std::size_t i, const dvec3& point, const query::ClosestPoint& answer);

  Errors errors;

 private:
  void expect_place(const std::string& where, const dvec3& local, double distance,
                    const query::ClosestPoint& answer) const;

  const DeviceScene& asked_;
  const Promise promise_;
  std::mutex mutex_;
};

}  // namespace kdray::test
