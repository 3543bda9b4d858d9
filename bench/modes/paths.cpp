#include "bench/modes/paths.h"

#include <algorithm>
#include <cmath>

#include "accel/flatten/collapse.h"

namespace kdray::bench {

namespace {

using layout::u32;

constexpr double kVisitCost = 1, kBlockCost = 2;

// A ray in the scene's own space.
struct Line {
  double origin[3], inverse[3];
  double t_min, t_max;
  u32 octant = 0;

  Line(const Ray& ray, const LocalSpace& space)
      : t_min(space.local_length(ray.t_min)), t_max(space.local_length(ray.t_max) * (1 + 1e-6)) {
    const dvec3 from = space.local({ray.origin[0], ray.origin[1], ray.origin[2]});
    for (int k = 0; k < 3; ++k) {
      origin[k] = from[k];
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

// The slots of a node from near to far, for rays of an octant.
u32 slot_at(const layout::WideNode& node, u32 octant, u32 nearer) {
  return node.order[octant] >> (3 * (flatten::kWidth - 1 - nearer)) & 7u;
}

class Walk {
 public:
  Walk(const flatten::WideForm& form, const odprt::Cut& cut, std::span<const u32> owner_of, Paths& paths)
      : form_(form), cut_(cut), owner_of_(owner_of), paths_(paths) {}

  void run(const Line& line) {
    if (!cut_.top.empty()) visit_opened(line, 0);
    paths_.first.push_back(paths_.visits.size());
  }

 private:
  template <class Enter>
  void for_each_met(const Line& line, const layout::WideNode& node, const Enter& enter) {
    for (u32 nearer = 0; nearer < flatten::kWidth; ++nearer) {
      const u32 slot = slot_at(node, line.octant, nearer);
      const bool empty = !(node.bounds[0][0][slot] <= node.bounds[0][1][slot]);
      if (!empty && line.meets(node, slot)) enter(slot);
    }
  }

  void visit_opened(const Line& line, std::size_t i) {
    count(kDirectory, kVisitCost);
    const layout::WideNode& node = form_.nodes[cut_.top[i].node];
    for_each_met(line, node, [&](u32 slot) {
      const std::int32_t below = cut_.top[i].below[slot];
      if (below >= 0)
        visit_opened(line, static_cast<std::size_t>(below));
      else
        visit_root(line, node.child[slot], owner_of_[static_cast<std::size_t>(-1 - below)]);
    });
  }

  void visit_root(const Line& line, u32 child, u32 owner) {
    const bool leaf = (child & KDRAY_WIDE_LEAF) != 0;
    leaf ? visit(line, child, owner) : visit_node(line, child, kDirectory, owner);
  }

  void visit(const Line& line, u32 child, u32 owner) {
    if ((child & KDRAY_WIDE_LEAF) != 0) return count(owner, kBlockCost * odprt::leaf_blocks(form_, child));
    visit_node(line, child, owner, owner);
  }

  void visit_node(const Line& line, u32 number, u32 owner, u32 owner_below) {
    count(owner, kVisitCost);
    const layout::WideNode& node = form_.nodes[number];
    for_each_met(line, node, [&](u32 slot) { visit(line, node.child[slot], owner_below); });
  }

  void count(u32 owner, double cost) {
    const bool there = paths_.visits.size() > paths_.first.back() && paths_.visits.back().owner == owner;
    if (!there) paths_.visits.push_back({owner, 0});
    paths_.visits.back().cost += static_cast<float>(cost);
  }

  const flatten::WideForm& form_;
  const odprt::Cut& cut_;
  std::span<const u32> owner_of_;
  Paths& paths_;
};

}  // namespace

Paths find_paths(const flatten::WideForm& form, const odprt::Cut& cut,
                 std::span<const std::uint32_t> owner_of, std::span<const LifeRay> lives,
                 const LocalSpace& space) {
  Paths paths;
  Walk walk(form, cut, owner_of, paths);
  for (const LifeRay& life : lives) walk.run(Line(life.ray, space));
  return paths;
}

std::vector<double> costs_of_owners(const Paths& paths, std::span<const LifeRay> lives, std::size_t n_owners,
                                    double shade_cost) {
  std::vector<double> costs(n_owners);
  std::vector<u32> end(lives.size(), kDirectory);  // the owner where each ray ends
  for (std::size_t i = 0; i < lives.size(); ++i) {
    if (lives[i].parent != kNoParent) end[i] = end[lives[i].parent];
    for (const Visit& v : paths.of(i)) {
      if (v.owner != kDirectory) end[i] = v.owner;
      if (end[i] != kDirectory) costs[end[i]] += v.cost;
    }
    if (end[i] != kDirectory && is_shaded(lives[i])) costs[end[i]] += shade_cost;
  }
  return costs;
}

}  // namespace kdray::bench
