#include "cluster/partition/zero_area.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>

#include "cluster/partition/wire.h"
#include "scene/model/zero_area.h"
#include "scene/primitives/pack.h"

namespace kdray::partition {

namespace {

constexpr std::size_t kGrainOfZeroArea = std::size_t{1} << 14;

using Triangles = std::vector<layout::Triangle>;

// Those of all ranks, in the order of the file.
Triangles gather_zero_area(const PrimitiveSet& set, transport::Together& all) {
  std::vector<layout::Triangle> own;
  for (const layout::Triangle& t : set.triangles)
    if (scene::is_zero_area(t)) own.push_back(t);
  const auto parts = all.gather(transport::bytes_of_list(std::span<const layout::Triangle>(own)));
  Triangles zero_area;
  for (int from = 0; from < all.size(); ++from) {
    const transport::Bytes& part = parts[static_cast<std::size_t>(from)];
    WireReader reader(part, from);
    reader.take(zero_area, part.size() / sizeof(layout::Triangle));
    reader.end();
  }
  return zero_area;
}

const layout::Triangle& triangle_of(const PrimitiveSet& set, std::uint32_t number) {
  return *std::ranges::lower_bound(set.triangles, number, {}, &layout::Triangle::number);
}

// For each side its neighbour's normal, from the rank that has the neighbour.
std::vector<vec3> normals_of_neighbours(const PrimitiveSet& set, scene::ZeroAreaSides& sides,
                                        transport::Together& all) {
  const std::vector<std::uint32_t> own(sides.neighbours().begin(), sides.neighbours().end());
  all.join_lists(sides.neighbours(),
                 [](std::uint32_t& least, std::uint32_t one) { least = std::min(least, one); });
  std::vector<vec3> normals(own.size(), vec3(0));
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i] != scene::ZeroAreaSides::kNobody && own[i] == sides.neighbours()[i])
      normals[i] = scene::ZeroAreaSides::normal_of(triangle_of(set, own[i]));
  all.join_lists(std::span<vec3>(normals), [](vec3& sum, const vec3& one) {
    if (sum == vec3(0)) sum = one;
  });
  return normals;
}

}  // namespace

void settle_zero_area(PrimitiveSet& set, transport::Together& all) {
  const Triangles zero_area = gather_zero_area(set, all);
  scene::ZeroAreaSides sides(zero_area);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, set.triangles.size(), kGrainOfZeroArea),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        sides.meet(set.triangles[i], set.triangles[i].number);
                    });
  const std::vector<vec3> neighbours = normals_of_neighbours(set, sides, all);
  const std::vector<vec3> normals = sides.normals([&](std::size_t side) { return neighbours[side]; });
  for (const std::uint32_t place : set.bare_zero_area) {
    const layout::Triangle& t = set.triangles[place];
    const auto found = std::ranges::lower_bound(zero_area, t.number, {}, &layout::Triangle::number);
    const vec3& normal = normals[static_cast<std::size_t>(found - zero_area.begin())];
    for (auto& at_corner : set.normals[t.normals & KDRAY_NORMALS_MASK].n) primitives::set(at_corner, normal);
  }
  set.bare_zero_area.clear();
}

}  // namespace kdray::partition
