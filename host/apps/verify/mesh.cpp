#include "apps/verify/mesh.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace kdray::verify {

namespace {

struct Place {
  vec3 point;
  std::uint32_t vertex;
  auto key() const { return std::tuple(point.x, point.y, point.z); }
};

// Returns the point of each of the file's vertices, as a number, and fills `points`. -0 and 0 are one place.
std::vector<std::uint32_t> weld(const scene::Scene& scene, const LocalSpace& space,
                                std::vector<vec3>& points) {
  std::vector<Place> places(scene.vertices.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    places[i] = {vec3(space.local(scene.vertices[i])) + vec3(0.0f), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(places, [](const Place& a, const Place& b) { return a.key() < b.key(); });
  std::vector<std::uint32_t> point_of(places.size());
  for (const Place& place : places) {
    if (points.empty() || points.back() != place.point) points.push_back(place.point);
    point_of[place.vertex] = static_cast<std::uint32_t>(points.size() - 1);
  }
  return point_of;
}

}  // namespace

dvec3 Mesh::normal(std::size_t triangle) const {
  if (zero_area[triangle] != 0) return dvec3(0);
  const dvec3 a(corner(triangle, 0)), b(corner(triangle, 1)), c(corner(triangle, 2));
  return glm::cross(b - a, c - a);
}

Box Mesh::bounds_of(std::size_t triangle) const {
  Box box;
  for (std::size_t k = 0; k < 3; ++k) box.grow(corner(triangle, k));
  return box;
}

Mesh make_mesh(const scene::Scene& scene, const scene::Geometry& geometry) {
  Mesh mesh;
  const std::vector<std::uint32_t> point_of = weld(scene, geometry.space, mesh.points);
  mesh.triangles.resize(geometry.triangles.size());
  mesh.numbers.resize(geometry.triangles.size());
  tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t i) {
    const scene::Triangle& from = scene.triangles[geometry.sources[i]];
    for (std::size_t k = 0; k < 3; ++k) mesh.triangles[i][k] = point_of[from.vertex[k]];
    mesh.numbers[i] = from.number;
  });
  mesh.zero_area.resize(mesh.triangles.size());
  for (const scene::ZeroAreaTriangle& s : geometry.zero_area) mesh.zero_area[s.triangle] = 1;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) mesh.bounds.grow(mesh.bounds_of(i));
  return mesh;
}

namespace {

constexpr std::size_t kMostInLeaf = 4;
constexpr std::uint32_t kParallelLevels = 6;

template <class Below>
void both(std::uint32_t level, const Below& below) {
  if (level < kParallelLevels) {
    tbb::parallel_invoke([&] { below(0); }, [&] { below(1); });
  } else {
    below(0), below(1);
  }
}

}  // namespace

Boxes::Boxes(const Mesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  if (n == 0) return;
  while ((n >> levels_) > kMostInLeaf) ++levels_;
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<vec3> middles(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    const Box box = mesh.bounds_of(i);
    middles[i] = 0.5f * box.lo + 0.5f * box.hi;  // no sum that overflows
  });
  sort_below(0, 0, middles);
  own_.resize(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) { own_[i] = mesh.bounds_of(order_[i]); });
  boxes_.resize((std::size_t{2} << levels_) - 1);
  bound_below(0, 0, mesh);
}

// Halves the node's triangles across the axis along which their middles reach farthest.
void Boxes::sort_below(std::uint32_t level, std::uint64_t j, const std::vector<vec3>& middles) {
  if (level == levels_) return;
  const auto at = [&](std::uint32_t l, std::uint64_t node) {
    return order_.begin() + static_cast<std::ptrdiff_t>(first_of(l, node));
  };
  const auto first = at(level, j), last = at(level, j + 1), middle = at(level + 1, 2 * j + 1);
  Box box;
  for (auto i = first; i != last; ++i) box.grow(middles[*i]);
  const vec3 e = box.extent();
  const int axis = e.x >= e.y && e.x >= e.z ? 0 : (e.y >= e.z ? 1 : 2);
  std::nth_element(first, middle, last, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(middles[a][axis], a) < std::pair(middles[b][axis], b);
  });
  both(level, [&](std::uint64_t side) { sort_below(level + 1, 2 * j + side, middles); });
}

void Boxes::bound_below(std::uint32_t level, std::uint64_t j, const Mesh& mesh) {
  Box& box = boxes_[(std::size_t{1} << level) - 1 + j];
  if (level == levels_) {
    for (std::size_t i = first_of(level, j); i < first_of(level, j + 1); ++i) box.grow(own_[i]);
    return;
  }
  both(level, [&](std::uint64_t side) { bound_below(level + 1, 2 * j + side, mesh); });
  box = box_of(level + 1, 2 * j);
  box.grow(box_of(level + 1, 2 * j + 1));
}

}  // namespace kdray::verify
