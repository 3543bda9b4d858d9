#include "engine/query/exact_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/query/scene_arguments.h"
#include "engine/query/surface.h"
#include "engine/query/wide_boxes.h"
#include "kdray/model.h"
#include "scene/primitives/shapes.h"

namespace kdray::query {

namespace {

using layout::WideNode;
using primitives::Line;

// Boxes hold their primitives but for the rounding of cones (kernels/closest/point.clh).
constexpr double kConesBeyondBoxes = 0x1p-19;
constexpr double kRounding = 0x1p-12;      // between a place and its floats, in a scene of 2^11
constexpr double kFloatsUnsure = 0x1p-19;  // of the reach
// The same within a scene's bounds, whose reach is below 2^12 from either end, vertices that move included.
static_assert(ExactScene::kNear == 0x1p13 * kFloatsUnsure + kRounding);

bool is_instance(std::uint32_t child) {
  return flatten::leaf_kind(child) == KDRAY_KIND_INSTANCE;
}

// Slots of a node whose boxes hold the place, widened by `margin`.
std::uint32_t holding(const WideNode& node, const dvec3& place, float margin) {
  const vec3 at(place);
  return choose_slots([&](int first) {
    SlotsChosen held = ~SlotsChosen{};
    for (int k = 0; k < 3; ++k)
      held &= (slots_at(node.bounds[k][0] + first) <= at[k] + margin) &
              (slots_at(node.bounds[k][1] + first) >= at[k] - margin);
    return held;
  });
}

// The corners of a triangle whose words begin at `rows`, `block` apart.
ExactLine::Corners corners_at(const layout::u32* rows, std::size_t block) {
  ExactLine::Corners corners;
  for (std::size_t i = 0; i < 9; ++i)
    corners[i / 3][static_cast<int>(i % 3)] = std::bit_cast<float>(rows[i * block]);
  return corners;
}

// The square of the distance from 0 to the line from a that goes as far as e.
double square_to_edge(const dvec3& a, const dvec3& e) {
  const dvec3 p = a + std::clamp(-glm::dot(a, e) / glm::dot(e, e), 0.0, 1.0) * e;
  return glm::dot(p, p);
}

bool is_within(double distance, const ExactLine::Corners& triangle, const dvec3& place) {
  const dvec3 a = triangle[0] - place, b = triangle[1] - place, c = triangle[2] - place;
  const dvec3 lo = glm::min(a, glm::min(b, c)), hi = glm::max(a, glm::max(b, c));
  if (glm::any(glm::greaterThan(lo, dvec3(distance))) || glm::any(glm::lessThan(hi, dvec3(-distance))))
    return false;
  const dvec3 ab = b - a, bc = c - b, ca = a - c, n = glm::cross(ab, c - a);
  if (std::abs(glm::dot(a, n)) > distance * glm::length(n)) return false;
  if (std::min({square_to_edge(a, ab), square_to_edge(b, bc), square_to_edge(c, ca)}) <= distance * distance)
    return true;
  return glm::dot(glm::cross(a, ab), n) >= 0 && glm::dot(glm::cross(b, bc), n) >= 0 &&
         glm::dot(glm::cross(c, ca), n) >= 0;
}

// A line in an instance's mesh's space, where t is 2^exponent times what it is in the scene's.
struct MeshLine {
  dvec3 origin, direction;
  int exponent;
};
MeshLine line_in_mesh(const layout::Instance& instance, const dvec3& origin, const dvec3& direction) {
  const dvec3 moved = by_rows(instance.to_mesh, direction);
  const int exponent = moved == dvec3(0) ? 0 : std::ilogb(largest_component(moved));
  return {in_mesh(instance, origin), moved * std::ldexp(1.0, -exponent), exponent};
}

// Where the line comes to the plane of a triangle, but no farther than the triangle goes along it.
double distance_to_plane(const Line& line, const layout::Triangle& triangle, double t) {
  const auto corner = [&](int i) {
    return dvec3(triangle.v[i][0], triangle.v[i][1], triangle.v[i][2]) - line.origin;
  };
  const dvec3 a = corner(0), b = corner(1), c = corner(2), n = glm::cross(b - a, c - a);
  const double facing = glm::dot(n, line.direction), length2 = glm::dot(line.direction, line.direction);
  if (facing == 0) return t;
  const dvec3 along =
      dvec3(glm::dot(a, line.direction), glm::dot(b, line.direction), glm::dot(c, line.direction)) / length2;
  return std::clamp(glm::dot(n, a) / facing, std::min({along.x, along.y, along.z}),
                    std::max({along.x, along.y, along.z}));
}

}  // namespace

// A half-line on its way through a tree: the scene's own, or that of an instance's mesh.
struct ExactScene::Walk {
  Walk(const dvec3& from, const dvec3& direction, double most, double margin, std::vector<ExactHit>& hits)
      : line(from, direction),
        origin(from),
        most(static_cast<float>(std::min(most, double{std::numeric_limits<float>::max()}))),
        margin(widened(margin, from)),
        hits(&hits) {
    constexpr float kMost = 0x1p100f;
    for (int k = 0; k < 3; ++k)
      inverse[k] = static_cast<float>(std::clamp(1 / direction[k], double{-kMost}, double{kMost}));
  }

  ExactLine line;
  vec3 origin, inverse;
  float most;    // boxes that it enters beyond this may be left out
  float margin;  // by which boxes are widened
  std::vector<ExactHit>* hits;
  std::uint32_t instance = kNoInstance;
  int exponent = 0;  // t is 2^exponent times the scene's

  // The slots of a node whose boxes it meets.
  std::uint32_t slots_of(const WideNode& node) const {
    return choose_slots([&](int first) {
      const auto lo = [&](int k) { return slots_at(node.bounds[k][0] + first); };
      Slots enter{}, leave = Slots{} + most;
      for (int k = 0; k < 3; ++k) {
        const Slots a = (lo(k) - (origin[k] + margin)) * inverse[k],
                    b = (slots_at(node.bounds[k][1] + first) - (origin[k] - margin)) * inverse[k];
        enter = greater(enter, lesser(a, b));
        leave = lesser(leave, greater(a, b));
      }
      return (enter <= leave) & (lo(0) <= slots_at(node.bounds[0][1] + first));
    });
  }

  void add(double t, double u, double v, std::uint32_t ref) const {
    if (t >= 0)
      hits->push_back(
          {std::ldexp(t, -exponent), static_cast<float>(u), static_cast<float>(v), ref, instance});
  }
};

ExactScene::ExactScene(const prepare::Prepared& scene)
    : scene_(&scene),
      margin_(scene.wide.widen * (kConesBeyondBoxes + kFloatsUnsure) * 2 * world_max(scene.geometry.bounds)) {
}

bool ExactScene::is_near(const dvec3& place) const {
  if (scene_->wide.nodes.size() == 0) return false;
  return is_near(0, place, margin_ + kNear, kNear);
}

bool ExactScene::is_near(std::uint32_t index, const dvec3& place, double margin, double within) const {
  const WideNode& node = scene_->wide.nodes[index];
  const auto block = static_cast<std::size_t>(scene_->wide.block);
  for (std::uint32_t slots = holding(node, place, widened(margin, place)); slots != 0; slots &= slots - 1) {
    const std::uint32_t child = node.child[std::countr_zero(slots)];
    if (!(child & KDRAY_WIDE_LEAF)) {
      if (is_near(child, place, margin, within)) return true;
    } else if (is_instance(child)) {
      if (is_near_instance(scene_->flat.instances[child & KDRAY_WIDE_FIRST_MASK], place)) return true;
    } else if (visit_leaf(scene_->wide, child, [&](auto kind, std::uint32_t i, const layout::u32* rows) {
                 using Kind = decltype(kind);
                 if constexpr (Kind::kIsShape)
                   return primitives::distance_to(Kind::of(scene_->flat)[i], place) <= within;
                 else
                   return is_within(within, corners_at(rows, block), place);
               })) {
      return true;
    }
  }
  return false;
}

// The ray is rounded once more on its way to the mesh's space (flatten/instances.h).
bool ExactScene::is_near_instance(const layout::Instance& instance, const dvec3& place) const {
  const dvec3 there = in_mesh(instance, place);
  double scaled = 0, moved = 0;  // by what lengths are multiplied, and the terms that the place is a sum of
  for (int row = 0; row < 3; ++row) {
    double sum = 0, terms = std::abs(instance.mesh_place[row]);
    for (int k = 0; k < 3; ++k) {
      const double factor = std::abs(double{instance.to_mesh[row][k]});
      sum += factor;
      terms += factor * std::abs(place[k] - instance.place[k]);
    }
    scaled = std::max(scaled, sum);
    moved = std::max(moved, terms);
  }
  const double reach = instance.reach;
  const double within = kFloatsUnsure * (largest_component(there) + reach + moved) + 2 * scaled * kRounding;
  return is_near(instance.root, there, 2 * (kConesBeyondBoxes + kFloatsUnsure) * reach + within, within);
}

void ExactScene::cross(std::uint32_t index, const Walk& walk) const {
  const WideNode& node = scene_->wide.nodes[index];
  const auto block = static_cast<std::size_t>(scene_->wide.block);
  for (std::uint32_t slots = walk.slots_of(node); slots != 0; slots &= slots - 1) {
    const std::uint32_t child = node.child[std::countr_zero(slots)];
    if (!(child & KDRAY_WIDE_LEAF)) {
      cross(child, walk);
    } else if (is_instance(child)) {
      const layout::Instance& instance = scene_->flat.instances[child & KDRAY_WIDE_FIRST_MASK];
      const MeshLine line = line_in_mesh(instance, walk.line.origin(), walk.line.direction());
      if (line.direction == dvec3(0)) continue;
      const double margin = 2 * (kConesBeyondBoxes + kFloatsUnsure) * instance.reach;
      Walk inside(line.origin, line.direction, std::ldexp(double{walk.most}, line.exponent), margin,
                  *walk.hits);
      inside.instance = instance.whole;
      inside.exponent = line.exponent;
      cross(instance.root, inside);
    } else {
      visit_leaf(scene_->wide, child, [&](auto kind, std::uint32_t i, const layout::u32* rows) {
        using Kind = decltype(kind);
        const std::uint32_t ref = Kind::kNumber << KDRAY_REF_KIND_SHIFT | i;
        if constexpr (Kind::kIsShape) {
          for (const auto& at :
               primitives::crossings({walk.line.origin(), walk.line.direction()}, Kind::of(scene_->flat)[i]))
            walk.add(at.t, at.u, 0, ref);
        } else if (const auto at = walk.line.crossing(corners_at(rows, block))) {
          walk.add(at->t, at->u, at->v, ref);
        }
        return false;
      });
    }
  }
}

void ExactScene::cross(const dvec3& origin, const dvec3& direction, double most,
                       std::vector<ExactHit>& hits) const {
  hits.clear();
  if (scene_->wide.nodes.size() == 0) return;
  cross(0, Walk(origin, direction, most, margin_, hits));
  sort(hits);
  const auto same = [](const ExactHit& a, const ExactHit& b) {
    return a.t == b.t && a.ref == b.ref && a.instance == b.instance;
  };
  hits.erase(std::unique(hits.begin(), hits.end(), same), hits.end());
}

void ExactScene::sort(std::vector<ExactHit>& hits) const {
  std::sort(hits.begin(), hits.end(), [&](const ExactHit& a, const ExactHit& b) {
    if (a.t != b.t) return a.t < b.t;
    if (a.instance != b.instance) return a.instance + 1 < b.instance + 1;  // what is in none comes first
    return a.ref != b.ref && number_of(scene_->flat, a.ref) < number_of(scene_->flat, b.ref);
  });
}

double ExactScene::distance(const dvec3& origin, const dvec3& direction, std::uint32_t ref,
                            std::uint32_t instance, double t) const {
  if (instance != kNoInstance) {
    const MeshLine line = line_in_mesh(scene_->flat.instances[instance], origin, direction);
    const double there = distance_in_mesh({line.origin, line.direction}, ref, std::ldexp(t, line.exponent));
    return std::ldexp(there, -line.exponent);
  }
  return distance_in_mesh({origin, direction}, ref, t);
}

double ExactScene::distance_in_mesh(const Line& line, std::uint32_t ref, double t) const {
  return primitives::with_kind(ref >> KDRAY_REF_KIND_SHIFT, [&](auto kind) {
    const auto& primitive = decltype(kind)::of(scene_->flat)[ref & KDRAY_REF_INDEX_MASK];
    if constexpr (decltype(kind)::kIsShape) {
      const primitives::Crossings all = primitives::crossings(line, primitive);
      const auto nearest = std::min_element(all.begin(), all.end(), [t](const auto& a, const auto& b) {
        return std::abs(a.t - t) < std::abs(b.t - t);
      });
      return nearest == all.end() ? t : nearest->t;
    } else {
      return distance_to_plane(line, primitive, t);
    }
  });
}

}  // namespace kdray::query
