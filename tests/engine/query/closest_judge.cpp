#include "engine/query/closest_judge.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/query/closest_scenes.h"
#include "engine/query/exact_distance.h"
#include "scene/primitives/shapes.h"

namespace kdray::test {

namespace {

struct Candidate {
  std::uint32_t number;
  Exact exact;
};

template <class Visit>
void for_each_primitive(const DeviceScene& queried, const Visit& visit) {
  primitives::for_each_kind([&](auto kind) {
    for (const auto& primitive : decltype(kind)::of(queried.prepared().flat)) visit(primitive);
  });
}

// The primitives that may be closest, by their exact distances; the closest first, of equal ones the smallest
// number.
std::vector<Candidate> candidates(const DeviceScene& queried, const dvec3& local, double allowed) {
  std::vector<std::pair<long double, std::uint32_t>> rough;
  for_each_primitive(queried, [&](const auto& p) { rough.emplace_back(rough_distance(local, p), p.number); });
  const long double least = std::min_element(rough.begin(), rough.end())->first;
  const long double margin = 0x1p-48L * (largest_component(local) + 0x1p11L) + 2 * allowed;
  std::vector<Candidate> found;
  std::size_t i = 0;
  for_each_primitive(queried, [&](const auto& p) {
    if (rough[i++].first <= least + margin) found.push_back({p.number, exact_distance(local, p)});
  });
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.exact != b.exact ? a.exact < b.exact : a.number < b.number;
  });
  return found;
}

double float_ulp(double x) {
  return std::ldexp(1.0, std::max(std::ilogb(x), -126) - 23);
}

}  // namespace

void Errors::add(double share, double float_ulps) {
  std::size_t k = 0;
  while (k + 1 < within.size() && share > std::ldexp(0.5, -52 + 2 * static_cast<int>(k))) ++k;
  ++within[k];
  ++n;
  most_float_ulps = std::max(most_float_ulps, float_ulps);
  most = std::max(most, share);
}

void Errors::print(const std::string& name) const {
  std::string line = fmt::format("{:<22} {:>6} points, {:>5} ties; at most {:.2g} ulp of float, 2^{:.1f}; ",
                                 name, n, ties, most_float_ulps, std::log2(most));
  for (std::size_t k = 0; k < within.size(); ++k)
    if (within[k] > 0) line += fmt::format(" {}:{}", 0.5 * std::pow(4.0, k), within[k]);
  fmt::print("{}\n", line);
}

void Judge::judge(std::size_t i, const dvec3& point, const query::ClosestPoint& answer) {
  const LocalSpace& space = asked_.space();
  const dvec3 local = space.local(point);
  const double allowed_of_scene = promise_.of_scene * 0x1p11;
  const std::vector<Candidate> all = candidates(asked_, local, allowed_of_scene);
  const Exact& least = all.front().exact;
  const Exact off = abs(Exact(space.local_length(answer.distance)) - least);
  const Exact allowed = promise_.share * least + allowed_of_scene;
  const double distance = least.get_d();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Candidate& c) {
    return c.number == static_cast<std::uint32_t>(answer.primitive);
  });
  const std::lock_guard lock(mutex_);
  const auto where = [&] {
    return fmt::format("point {} ({}, {}, {}), seed {}: {} of {}, exactly {:.17g} of {}", i, point.x, point.y,
                       point.z, kClosestSeed, answer.distance, answer.primitive, space.world_length(distance),
                       all.front().number);
  };
  EXPECT_LE(off, allowed) << where();
  if (distance > 0x1p20 * allowed_of_scene)
    errors.add(Exact(off / least).get_d(), Exact(off / float_ulp(distance)).get_d());
  ASSERT_NE(found, all.end()) << where();
  EXPECT_LE(found->exact - least, allowed) << where();
  // Of equal ones the smallest number, unless one that is smaller still rounds to the same.
  if (promise_.share == kInDoubles.share && found->exact - least <= 0x1p-52 * least) {
    EXPECT_LE(answer.primitive, static_cast<std::int32_t>(all.front().number)) << where() << ", a tie";
  }
  if (all.size() > 1 && all[1].exact == least) ++errors.ties;
  expect_place(where(), local, distance, answer);
}

// The point is on the primitive, and as far away as it is said to be.
void Judge::expect_place(const std::string& where, const dvec3& local, double distance,
                         const query::ClosestPoint& answer) const {
  const LocalSpace& space = asked_.space();
  const dvec3 place = space.local(answer.point);
  const double size = largest_component(local) + 0x1p11 + largest_component(space.center) * space.scale;
  double tolerance = promise_.place * size;
  if (largest_component(local) > 0x1p36) tolerance = 0x1p-50 * size + 0x1p-4;
  EXPECT_NEAR(static_cast<double>(glm::length(local - place)), distance, tolerance) << where;
  double away = std::numeric_limits<double>::infinity();
  for_each_primitive(asked_, [&](const auto& p) {
    if (static_cast<std::int32_t>(p.number) == answer.primitive)
      away = static_cast<double>(rough_distance(place, p));
  });
  EXPECT_LE(away, tolerance) << where;
}

}  // namespace kdray::test
