#include "bench/modes_paths.h"

#include <cmath>

namespace kdray::bench {

namespace {

using layout::u32;

// A ray about the scene's centre.
struct Line {
  double origin[3], inverse[3];
  double t_min, t_max;
  u32 octant = 0;

  Line(const Ray& ray, const dvec3& center) : t_min(ray.t_min), t_max(ray.t_max * (1 + 1e-6)) {
    for (int k = 0; k < 3; ++k) {
      origin[k] = ray.origin[k] - center[k];
      const double along = ray.direction[k];
      inverse[k] = 1 / (std::abs(along) < 1e-18 ? std::copysign(1e-18, along) : along);
      if (std::signbit(along)) octant |= 1u << k;
    }
  }

  bool meets(const layout::WideNode& node, u32 slot) const {
    double enter = t_min, leave = t_max;
    for (int k = 0; k < 3; ++k) {
      const bool backwards = (octant >> k & 1u) != 0;
      enter = std::max(enter, (node.bounds[k][backwards ? 1 : 0][slot] - origin[k]) * inverse[k]);
      leave = std::min(leave, (node.bounds[k][backwards ? 0 : 1][slot] - origin[k]) * inverse[k]);
    }
    return enter <= leave * (1 + 1e-12);
  }
};

class Walk {
 public:
  Walk(const flatten::WideForm& form, const Cut& cut, Paths& paths) : form_(form), cut_(cut), paths_(paths) {}

  void run(const Line& line) {
    visit(line, 0, cut_.piece_of_node(0));
    paths_.first.push_back(paths_.visits.size());
  }

 private:
  void visit(const Line& line, u32 index, u32 piece) {
    count(piece, kVisitCost);
    const layout::WideNode& node = form_.nodes[index];
    for (u32 nearer = 0; nearer < 8; ++nearer) {
      const u32 slot = slot_at(node, line.octant, nearer);
      if (!(node.bounds[0][0][slot] <= node.bounds[0][1][slot]) || !line.meets(node, slot)) continue;
      const u32 child = node.child[slot];
      if ((child & KDRAY_WIDE_LEAF) != 0) {
        count(piece == kDirectory ? cut_.piece_of_leaf(index, slot) : piece,
              kBlockCost * blocks_of_leaf(form_, child));
      } else {
        visit(line, child, piece == kDirectory ? cut_.piece_of_node(child) : piece);
      }
    }
  }

  void count(u32 piece, double cost) {
    const bool there = paths_.visits.size() > paths_.first.back() && paths_.visits.back().piece == piece;
    if (!there) paths_.visits.push_back({piece, 0});
    paths_.visits.back().cost += static_cast<float>(cost);
  }

  const flatten::WideForm& form_;
  const Cut& cut_;
  Paths& paths_;
};

}  // namespace

Paths find_paths(const flatten::WideForm& form, const Cut& cut, std::span<const LifeRay> lives,
                 const dvec3& center) {
  Paths paths;
  Walk walk(form, cut, paths);
  for (const LifeRay& life : lives) {
    if (form.nodes.empty())
      paths.first.push_back(0);
    else
      walk.run(Line(life.ray, center));
  }
  return paths;
}

std::vector<double> costs_of_pieces(const Paths& paths, std::span<const LifeRay> lives, std::size_t n_pieces,
                                    double shade_cost) {
  std::vector<double> costs(n_pieces);
  std::vector<std::uint32_t> end(lives.size(), kDirectory);  // the piece where each ray ends
  for (std::size_t i = 0; i < lives.size(); ++i) {
    if (lives[i].parent != kNoParent) end[i] = end[lives[i].parent];
    for (const PieceVisit& v : paths.of(i)) {
      if (v.piece != kDirectory) end[i] = v.piece;
      if (end[i] != kDirectory) costs[end[i]] += v.cost;
    }
    if (end[i] != kDirectory && is_shaded(lives[i])) costs[end[i]] += shade_cost;
  }
  return costs;
}

}  // namespace kdray::bench
