#include "apps/verify/duplicates.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kdray::verify {

namespace {

struct Triple {
  Corners corners;  // ascending
  std::uint32_t face;
  auto key() const { return std::pair(corners, face); }
};

std::vector<std::uint32_t> find_doubled(const Mesh& mesh) {
  std::vector<Triple> triples(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, triples.size(), [&](std::size_t i) {
    triples[i] = {mesh.triangles[i], static_cast<std::uint32_t>(i)};
    std::sort(triples[i].corners.begin(), triples[i].corners.end());
  });
  tbb::parallel_sort(triples, [](const Triple& a, const Triple& b) { return a.key() < b.key(); });
  std::vector<std::uint32_t> doubled;
  for (std::size_t i = 1; i < triples.size(); ++i)
    if (triples[i].corners == triples[i - 1].corners) doubled.push_back(triples[i].face);
  std::sort(doubled.begin(), doubled.end());
  return doubled;
}

using Points = std::array<dvec3, 3>;

Points points_of(const Mesh& mesh, std::uint32_t face) {
  return {dvec3(mesh.corner(face, 0)), dvec3(mesh.corner(face, 1)), dvec3(mesh.corner(face, 2))};
}

double largest(const Points& p) {
  double most = 0;
  for (const dvec3& v : p)
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(v[k]));
  return most;
}

bool in_plane(const Points& p, const dvec3& unit_normal, const dvec3& in_it, double tolerance) {
  return std::all_of(p.begin(), p.end(),
                     [&](const dvec3& v) { return std::abs(glm::dot(unit_normal, v - in_it)) <= tolerance; });
}

// Returns whether one of a's edges has all of b beyond it, or no deeper on a's side than `tolerance`.
bool separated_by_edge(const Points& a, const Points& b, const dvec3& unit_normal, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) {
    const dvec3 from = a[k], edge = a[(k + 1) % 3] - from;
    const dvec3 inward = glm::cross(unit_normal, edge) / glm::length(edge);
    const auto depth = [&](const dvec3& v) { return glm::dot(inward, v - from); };
    if (std::max({depth(b[0]), depth(b[1]), depth(b[2])}) <= tolerance) return true;
  }
  return false;
}

}  // namespace

bool overlap(const Mesh& mesh, std::uint32_t i, std::uint32_t j) {
  const Points a = points_of(mesh, i), b = points_of(mesh, j);
  const double tolerance = 0x1p-22 * std::max(largest(a), largest(b));
  const dvec3 na = mesh.normal(i), nb = mesh.normal(j);
  const double la = glm::length(na), lb = glm::length(nb);
  if (!(la > 0 && lb > 0)) return false;  // less than double's smallest
  if (!in_plane(b, na / la, a[0], tolerance) || !in_plane(a, nb / lb, b[0], tolerance)) return false;
  return !separated_by_edge(a, b, na / la, 4 * tolerance) && !separated_by_edge(b, a, nb / lb, 4 * tolerance);
}

Duplicates find_duplicates(const Mesh& mesh, const Boxes& boxes) {
  Duplicates found;
  found.doubled = find_doubled(mesh);
  const auto is_doubled = [&](std::uint32_t face) {
    return std::binary_search(found.doubled.begin(), found.doubled.end(), face);
  };
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  tbb::enumerable_thread_specific<Pairs> pairs;
  boxes.touching_pairs([&](std::uint32_t a, std::uint32_t b) {
    if (overlap(mesh, a, b) && !is_doubled(a) && !is_doubled(b)) pairs.local().push_back(std::minmax(a, b));
  });
  for (const Pairs& some : pairs) found.overlapping.insert(found.overlapping.end(), some.begin(), some.end());
  std::sort(found.overlapping.begin(), found.overlapping.end());
  return found;
}

}  // namespace kdray::verify
