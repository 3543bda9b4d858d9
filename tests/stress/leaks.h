// What    Families of rays from inside of closed meshes: where they begin and where they go; tracing them by
//         every walk, where each miss is a leak.
#pragma once

#include <cstdint>
#include <string>

#include "kdray/kdray.h"
#include "stress/meshes.h"
#include "stress/random.h"
#include "stress/traced.h"

namespace kdray::stress {

// In each family the origin is inside; what differs is where it is and where the ray goes. `axis`: whatever
// the direction has to know of the origin.
struct Family {
  const char* name;
  dvec3 (*origin)(const ClosedMesh&, Random&, int* axis);
  dvec3 (*direction)(const ClosedMesh&, Random&, const Origin&);
};
void PrintTo(const Family& f, std::ostream* out);
std::string name_of_test(const Family& f);

dvec3 anywhere(const ClosedMesh& mesh, Random& random, int* axis);
dvec3 within(const ClosedMesh& mesh, Random& random);
// A corner of the mesh, or a point of one of its edges.
dvec3 vertex_of(const ClosedMesh& mesh, Random& random);
dvec3 edge_point_of(const ClosedMesh& mesh, Random& random);
dvec3 at_a_vertex(const ClosedMesh& mesh, Random& random, const Origin& o);
dvec3 at_an_edge(const ClosedMesh& mesh, Random& random, const Origin& o);

// Makes a family's rays from origins that are inside.
class RaysInside {
 public:
  RaysInside(const ClosedMesh& mesh, const Family& family, std::uint64_t seed);
  bool any() const { return !origins_.empty(); }
  Ray operator()(std::uint64_t i) const;

 private:
  const ClosedMesh& mesh_;
  const Family& family_;
  std::uint64_t seed_;
  std::vector<Origin> origins_;
};

inline bool is_leak(const Hit& hit) {
  return hit.primitive < 0;
}

// Rays are counted as often as they are traced: by five walks, a quarter of them for occlusion too.
inline constexpr double kTraces = 5 * 1.25;

// Traces a family's share. `rays`: of each walk.
void trace_family(ClosedMesh& mesh, const Family& family, std::uint64_t seed, std::uint64_t rays,
                  Tally& tally);

// That there was no leak.
void expect_tight(const Tally& tally, std::uint64_t seed);

}  // namespace kdray::stress
