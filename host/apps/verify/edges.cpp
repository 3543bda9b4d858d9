#include "apps/verify/edges.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace kdray::verify {

namespace {

// Sets of faces that grow together, and within a set whether a face is turned over against the set's first.
// Source: Tarjan 1975 with path halving left out: parities are added up on the way.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n), size_(n, 1), turned_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  struct Member {
    std::uint32_t root;
    bool turned;
  };
  Member find(std::uint32_t face) const {
    Member member{face, false};
    while (parent_[member.root] != member.root) {
      member.turned ^= turned_[member.root] != 0;
      member.root = parent_[member.root];
    }
    return member;
  }

  // False when the two are in one set already and stand otherwise to each other.
  bool join(std::uint32_t a, std::uint32_t b, bool turned) {
    Member p = find(a), q = find(b);
    const bool between = p.turned ^ q.turned ^ turned;
    if (p.root == q.root) return !between;
    if (size_[p.root] < size_[q.root]) std::swap(p, q);
    parent_[q.root] = p.root;
    size_[p.root] += size_[q.root];
    turned_[q.root] = between;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_, size_;  // by size: no path is longer than log2(n)
  std::vector<std::uint8_t> turned_;
};

// An edge as one of its faces sees it.
struct FaceSide {
  std::uint64_t key;  // both points
  std::uint32_t face;
  bool forward;  // the face runs from the smaller point to the larger
  auto order() const { return std::pair(key, face); }
};

std::vector<FaceSide> sorted_sides(const Mesh& mesh) {
  std::vector<FaceSide> sides(3 * mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = mesh.triangles[i][k], b = mesh.triangles[i][(k + 1) % 3];
      sides[3 * i + k] = {std::min(a, b) << 32 | std::max(a, b), static_cast<std::uint32_t>(i), a < b};
    }
  });
  tbb::parallel_sort(sides, [](const FaceSide& a, const FaceSide& b) { return a.order() < b.order(); });
  return sides;
}

class Finder {
 public:
  explicit Finder(const Mesh& mesh)
      : mesh_(mesh), joined_(mesh.triangles.size()), agreeing_(mesh.triangles.size()) {}

  Topology find() {
    const std::vector<FaceSide> sides = sorted_sides(mesh_);
    for (std::size_t first = 0, last; first < sides.size(); first = last) {
      for (last = first + 1; last < sides.size() && sides[last].key == sides[first].key; ++last) {
      }
      take_edge(std::span(sides).subspan(first, last - first));
    }
    out_.loops = count_loops();
    name_components();
    count_faces();
    find_flipped();
    return std::move(out_);
  }

 private:
  void take_edge(std::span<const FaceSide> sides) {
    const Edge edge{static_cast<std::uint32_t>(sides[0].key >> 32), static_cast<std::uint32_t>(sides[0].key),
                    sides[0].face};
    ++out_.n_edges;
    for (const FaceSide& side : sides.subspan(1)) joined_.join(sides[0].face, side.face, false);
    if (sides.size() == 1) out_.open.push_back(edge);
    if (sides.size() % 2 == 1) odd_.push_back(edge.triangle);
    if (sides.size() > 2) out_.crowded.push_back(edge);
    if (sides.size() != 2) return;
    const bool turned = sides[0].forward == sides[1].forward;
    if (turned) out_.turned.push_back(edge);
    if (!agreeing_.join(sides[0].face, sides[1].face, turned)) contradicted_.push_back(edge.triangle);
  }

  // Points that open edges join.
  std::size_t count_loops() const {
    std::vector<std::uint32_t> points;
    for (const Edge& e : out_.open) points.insert(points.end(), {e.a, e.b});
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    const auto place = [&](std::uint32_t point) {
      return static_cast<std::uint32_t>(std::lower_bound(points.begin(), points.end(), point) -
                                        points.begin());
    };
    Sets joined(points.size());
    std::size_t loops = points.size();
    for (const Edge& e : out_.open) {
      const std::uint32_t a = place(e.a), b = place(e.b);
      loops -= joined.find(a).root != joined.find(b).root;
      joined.join(a, b, false);
    }
    return loops;
  }

  void name_components() {
    const std::size_t n = mesh_.triangles.size();
    std::vector<std::uint32_t> size(n), roots;
    out_.component_of.resize(n);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      out_.component_of[i] = joined_.find(static_cast<std::uint32_t>(i)).root;
    });
    for (std::size_t i = 0; i < n; ++i) {
      if (size[out_.component_of[i]]++ == 0) roots.push_back(out_.component_of[i]);
    }
    std::stable_sort(roots.begin(), roots.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return size[a] > size[b]; });
    std::vector<std::uint32_t> name(n);
    for (std::size_t i = 0; i < roots.size(); ++i) name[roots[i]] = static_cast<std::uint32_t>(i);
    for (std::uint32_t& c : out_.component_of) c = name[c];
    out_.components.resize(roots.size());
  }

  Component& component_of(std::uint32_t face) { return out_.components[out_.component_of[face]]; }

  void count_faces() {
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      Component& c = component_of(i);
      if (c.faces++ == 0) c.first = i;
      c.bounds.grow(mesh_.bounds_of(i));
      // The volume is taken about a point of the component's own, so that its place costs no digits.
      const dvec3 from(mesh_.corner(c.first, 0));
      c.volume += glm::dot(dvec3(mesh_.corner(i, 0)) - from, mesh_.normal(i)) / 6;
    }
    for (const Edge& e : out_.open) ++component_of(e.triangle).open_edges;
    for (const Edge& e : out_.crowded) ++component_of(e.triangle).crowded_edges;
    for (const Edge& e : out_.turned) ++component_of(e.triangle).turned_edges;
    for (const std::uint32_t face : odd_) component_of(face).watertight = false;
    for (const std::uint32_t face : contradicted_) component_of(face).one_sided = true;
  }

  void find_flipped() {
    if (out_.turned.empty()) return;
    const std::size_t n = mesh_.triangles.size();
    std::vector<std::array<std::uint32_t, 2>> faces(n);
    std::vector<std::uint8_t> one_sided(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      const Sets::Member member = agreeing_.find(i);
      ++faces[member.root][member.turned];
    }
    for (const std::uint32_t face : contradicted_) one_sided[agreeing_.find(face).root] = 1;
    for (std::uint32_t i = 0; i < n; ++i) {
      const Sets::Member member = agreeing_.find(i);
      const auto& [straight, turned] = faces[member.root];
      if (turned == 0 || one_sided[member.root]) continue;
      if (member.turned != (turned > straight)) {
        out_.flipped.push_back(i);
        ++component_of(i).flipped;
      }
    }
  }

  const Mesh& mesh_;
  Sets joined_, agreeing_;
  std::vector<std::uint32_t> odd_, contradicted_;  // a face of each such edge
  Topology out_;
};

}  // namespace

std::size_t Topology::count(bool (*what)(const Component&)) const {
  return static_cast<std::size_t>(std::count_if(components.begin(), components.end(), what));
}

Topology find_topology(const Mesh& mesh) {
  return Finder(mesh).find();
}

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
