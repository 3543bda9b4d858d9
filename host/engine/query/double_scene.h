// What    A scene of doubles (TreeOptions::geometry) asked by rays and points, on the host: what exact
//         arithmetic says of the vertices and rays as the caller gave them. Of many rays the device has told
//         first what floats are sure of (primitives/triangle/filter.clh), and these are the rest.
// Shape   Rays walk through the wide tree (double_walk.h), whose boxes are those of the floats, widened.
//         Which triangles a line crosses goes by the half-open rule with exact signs (exact_triangle.h), for
//         closest hits too: of what shares an edge one is hit. Which of two comes first is decided exactly;
//         at one t it is the one with the lower number. t is bounded first, and found to its last place for
//         what is told and where bounds overlap. Shapes are crossed in pairs of doubles
//         (primitives/shape_tools.h), and come before or after others by t to 2^-96 of itself, in one place
//         after triangles.
// Errors  t is the double nearest to the exact one, nearly always, and off by less than two of its last
//         places. It is compared with t_min and t_max as such; its sign is exact. Distances of points are off
//         by some 2^-50 of themselves, to shapes of the coordinates.
// Why     Boxes: a vertex is off by u of the scene's reach W in floats, so that what a triangle's floats have
//         in a cell its doubles have within u*W, and the boxes of pieces are off by some u*W more
//         (kdtree/clip.h). A walk's floats lose 4u of the lengths in play, |o| + 2W. The margin is 64u*W and
//         32u*|o|. Shapes' centres, radii and directions are off by 5u*W together; a cone whose ends lie
//         close together is tilted by more, which is added (DoubleGeometry::apart).
// Threads As many calls at once as there are threads.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/double_hits.h"
#include "engine/query/exact_scene.h"
#include "engine/query/geometry_table.h"
#include "engine/query/local_rays.h"

namespace kdray::query {

class DoubleScene {
 public:
  // Of a scene that has doubles; `table` tells masks, which mean nothing without one.
  explicit DoubleScene(const prepare::Prepared& scene, const GeometryTable* table = nullptr);

  struct Question {
    DoubleRay ray;
    std::uint32_t mask;
    std::size_t place;  // of its answer; what is at other places stays
  };
  // t as the caller's rays have it.
  void closest(std::span<const Question> questions, std::span<std::optional<ExactHit>> hits) const;
  // Of n triangles that lines cross for certain, line(i) that of triangle(i): calls told(i, hit) for each.
  template <class LineOf, class TriangleOf, class Told>
  void tell(std::size_t n, const LineOf& line, const TriangleOf& triangle, const Told& told) const;
  void any(std::span<const Question> questions, std::span<std::uint8_t> hit) const;
  // Of count and all: a hit at t = 0 counts where t_min is 0.
  void count(std::span<const Question> questions, std::span<std::uint32_t> counts) const;
  // Sorted.
  void all(std::span<const Question> questions, std::span<std::vector<ExactHit>> hits) const;

  struct Nearest {
    double distance;
    dvec3 point;
    std::uint32_t ref;
    double u, v;
  };
  // Of what lies within `most` of the place; of several at one distance the one with the lowest number. All
  // in the scene's space. (double_nearest.cpp)
  std::optional<Nearest> nearest(const dvec3& place, double most) const;

 private:
  struct Candidate;
  class Line;
  template <class Found>
  class RayDecider;
  std::uint32_t number_of(std::uint32_t ref) const;
  bool is_seen(std::uint32_t ref, std::uint32_t mask) const;
  template <class Found>
  std::vector<Line> walk(std::span<const Question> questions, bool from_start, const Found& found) const;
  template <class Collected>
  void collect(std::span<const Question> questions, const Collected& collected) const;
  // Calls told(i, hit) for each of n candidates, whose questions are question(i).
  template <class QuestionOf, class CandidateOf, class Told>
  void tell_candidates(std::size_t n, const QuestionOf& question, const CandidateOf& candidate,
                       const Told& told) const;

  static ExactLine exact(const DoubleLine& line) { return {line.origin, line.direction, line.rest}; }
  static std::uint32_t ref_of(std::uint32_t triangle) {
    return std::uint32_t{KDRAY_KIND_TRIANGLE} << KDRAY_REF_KIND_SHIFT | triangle;
  }
  static bool is_triangle(std::uint32_t ref) { return ref >> KDRAY_REF_KIND_SHIFT == KDRAY_KIND_TRIANGLE; }
  // Fetches the corners' numbers of triangle i, or its vertices, where there is one. (Inlined: g++ takes a
  // function that does nothing else for one without effect, and leaves out calls of it.)
  [[gnu::always_inline]] void fetch_corners(std::size_t i, std::size_t n, const auto& triangle) const {
    if (i < n) __builtin_prefetch(&doubles_->corners[triangle(i)]);
  }
  [[gnu::always_inline]] void fetch_vertices(std::size_t i, std::size_t n, const auto& triangle) const {
    if (i >= n) return;
    for (const std::uint32_t vertex : doubles_->corners[triangle(i)])
      __builtin_prefetch(&doubles_->vertices[vertex]);
  }

  const prepare::Prepared* scene_;
  const scene::DoubleGeometry* doubles_;
  const GeometryTable* table_;
  double reach_, margin_;
  bool has_every_bit_;  // in all of the table's masks
};

template <class LineOf, class TriangleOf, class Told>
void DoubleScene::tell(std::size_t n, const LineOf& line, const TriangleOf& triangle,
                       const Told& told) const {
  constexpr std::size_t kLanes = CrossedTriangles::kLanes;
  std::array<DoubleLine, kLanes> lines;
  CrossedTriangles crossed;
  ToldHits hits;
  for (std::size_t i = 0; i < 2 * kLanes; ++i) fetch_corners(i, n, triangle);
  for (std::size_t i = 0; i < kLanes; ++i) fetch_vertices(i, n, triangle);
  for (std::size_t first = 0; first < n; first += kLanes) {
    const std::size_t here = std::min(kLanes, n - first);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t i = first + std::min(lane, here - 1);
      fetch_corners(i + 2 * kLanes, n, triangle);
      fetch_vertices(i + kLanes, n, triangle);
      lines[lane] = line(i);
      crossed.put(lane, lines[lane], doubles_->at(triangle(i)));
    }
    tell_hits(crossed, hits);
    for (std::size_t lane = 0; lane < here; ++lane) {
      const std::uint32_t at = triangle(first + lane);
      const double t = hits.is_sure[lane] != 0 ? hits.t[lane] : exact(lines[lane]).t_of(doubles_->at(at));
      told(first + lane,
           ExactHit{lines[lane].caller_t(t), hits.u[lane], hits.v[lane], ref_of(at), kNoInstance});
    }
  }
}

}  // namespace kdray::query
