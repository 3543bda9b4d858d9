#include "engine/query/double_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "engine/query/scene_arguments.h"
#include "engine/query/surface.h"
#include "engine/query/wide_boxes.h"

namespace kdray::query {

namespace {

using layout::WideNode;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBoxes = 0x1p-18;  // 64u of the reach: see double_scene.h

// Below this, as a share of either, two values of t may be in the other order.
constexpr double kSureOrder = 0x1p-50;
bool is_sure_order(double a, double b) {
  return std::abs(a - b) > kSureOrder * std::max(std::abs(a), std::abs(b));
}

float rounded_down(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return std::nextafterf(static_cast<float>(std::clamp(value, -kMost, kMost)), -HUGE_VALF);
}
float rounded_up(double value) {
  return -rounded_down(-value);
}

dvec3 without_tiny(dvec3 v) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(v[k]) < scene::DoubleTriangles::kLeast) v[k] = 0;
  return v;
}

std::uint32_t ref_of(std::uint32_t triangle) {
  return std::uint32_t{KDRAY_KIND_TRIANGLE} << KDRAY_REF_KIND_SHIFT | triangle;
}

// Calls visit(rows, n, block) for each block of a leaf of triangles, of which the first n lanes are there,
// until a call answers false; whether none did.
template <class Visit>
bool visit_blocks(const flatten::WideForm& wide, std::uint32_t leaf, const Visit& visit) {
  const auto block = static_cast<std::size_t>(wide.block);
  constexpr std::size_t kRows = KDRAY_TRIANGLE_ROWS;
  const layout::u32* rows = wide.triangle_blocks.data() + (leaf & KDRAY_WIDE_FIRST_MASK) * kRows * block;
  for (;; rows += kRows * block) {
    const layout::u32* const index = rows + (kRows - 1) * block;
    std::size_t n = 0;
    while (n < block && !(index[n] & KDRAY_WIDE_LAST)) ++n;
    const bool is_last = n < block;
    if (is_last) ++n;
    if (!visit(rows, n)) return false;
    if (is_last) return true;
  }
}

}  // namespace

DoubleScene::DoubleScene(const prepare::Prepared& scene, const GeometryTable& table)
    : scene_(&scene),
      doubles_(scene.doubles.get()),
      table_(&table),
      reach_(world_max(scene.geometry.bounds)),
      margin_(kBoxes * reach_) {}

// A ray on its way. What it finds it tells found(hit), whose t, the local one, is all that is known yet: how
// far it goes on, or nothing: no farther.
class DoubleScene::Walk {
 public:
  Walk(const DoubleScene& scene, const DoubleRay& ray)
      : line(without_tiny(ray.origin), without_tiny(ray.direction), without_tiny(ray.rest)),
        scene_(scene),
        ray_(ray) {
    const dvec3 start = ray.origin + ray.rest + ray.start * ray.direction;
    origin_ = vec3(start);
    margin_ = widened(scene.margin_, start);
    constexpr float kMost = 0x1p100f;
    for (int k = 0; k < 3; ++k) {
      inverse_[k] = static_cast<float>(std::clamp(1 / ray.direction[k], double{-kMost}, double{kMost}));
      octant_ |= (ray.direction[k] < 0 ? 1u : 0u) << k;
    }
    begin_ = rounded_down(ray.t_min - ray.start - slack(ray.t_min));
    end_at(ray.t_max);
    choose_axes();
  }

  const ExactLine line;

  template <class Found>
  void run(const Found& found) {
    if (scene_.scene_->wide.nodes.size() == 0 || !(begin_ <= end_)) return;
    thread_local std::vector<Entry> stack;
    stack.clear();
    open(0, stack);
    while (!stack.empty()) {
      const Entry entry = stack.back();
      stack.pop_back();
      if (entry.enter > end_) continue;
      if (!(entry.child & KDRAY_WIDE_LEAF)) {
        open(entry.child, stack);
      } else if (!test(entry.child, found)) {
        return;
      }
    }
  }

 private:
  struct Entry {
    float enter;
    std::uint32_t child;
  };

  // Between t here and in floats from the start on.
  double slack(double t) const {
    return 0x1p-48 * (std::abs(ray_.start) + (std::isinf(t) ? 0 : std::abs(t)));
  }
  void end_at(double t) { end_ = rounded_up(t - ray_.start + slack(t)); }

  void open(std::uint32_t index, std::vector<Entry>& stack) const {
    const WideNode& node = scene_.scene_->wide.nodes[index];
    float enters[8];
    const std::uint32_t slots = choose_slots([&](int first) {
      Slots enter = Slots{} + begin_, leave = Slots{} + end_;
      for (int k = 0; k < 3; ++k) {
        const Slots a = (slots_at(node.bounds[k][0] + first) - (origin_[k] + margin_)) * inverse_[k],
                    b = (slots_at(node.bounds[k][1] + first) - (origin_[k] - margin_)) * inverse_[k];
        enter = greater(enter, lesser(a, b));
        leave = lesser(leave, greater(a, b));
      }
      std::memcpy(enters + first, &enter, sizeof enter);
      return (enter <= leave) & (slots_at(node.bounds[0][0] + first) <= slots_at(node.bounds[0][1] + first));
    });
    for (std::uint32_t order = node.order[octant_], i = 0; i < 8; ++i, order >>= 3)
      if (const std::uint32_t slot = order & 7; slots >> slot & 1)
        stack.push_back({enters[slot], node.child[slot]});
  }

  // The triangles' plane in floats: z along the direction's largest component.
  void choose_axes() {
    const dvec3 d = glm::abs(ray_.direction);
    kz_ = d.x >= d.y && d.x >= d.z ? 0 : (d.y >= d.z ? 1 : 2);
    kx_ = (kz_ + 1) % 3;
    ky_ = (kz_ + 2) % 3;
    sx_ = static_cast<float>(ray_.direction[kx_] / ray_.direction[kz_]);
    sy_ = static_cast<float>(ray_.direction[ky_] / ray_.direction[kz_]);
    const double most = 2 * scene_.reach_ + largest_component(dvec3(origin_));
    displaced_ = static_cast<float>(16 * 0x1p-24 * most);
  }

  // Which of four triangles may be crossed. A corner's place in the plane across the line, sheared, is off by
  // 16u of what the largest of its lengths can be: 2u for the rounding of vertex and origin, each also by
  // way of the shear, and 9u for that of the operations. Where it is off by no more than e, and no corner's
  // coordinate is above m, an edge function is off by 4*e*m + 2*e^2, and by 3u of 2*m^2 for its own rounding.
  SlotsChosen may_cross(const layout::u32* rows, std::size_t block) const {
    Slots x[3], y[3], most{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = [&](int k) {
        Slots values;
        std::memcpy(&values, rows + (3 * i + static_cast<std::size_t>(k)) * block, sizeof values);
        return values - origin_[k];
      };
      const Slots z = at(kz_);
      x[i] = at(kx_) - sx_ * z;
      y[i] = at(ky_) - sy_ * z;
      most = greater(most, greater(greater(x[i], -x[i]), greater(y[i], -y[i])));
    }
    const Slots bound = 1.01f * (most * (4 * displaced_ + 0x1p-21f * most) + 2 * displaced_ * displaced_);
    const auto edge = [&](int p, int q) { return x[q] * y[p] - y[q] * x[p]; };
    const Slots a = edge(1, 2), b = edge(2, 0), c = edge(0, 1);
    return ~((lesser(a, lesser(b, c)) < -bound) & (greater(a, greater(b, c)) > bound));
  }

  template <class Found>
  bool test(std::uint32_t leaf, const Found& found) {
    const auto block = static_cast<std::size_t>(scene_.scene_->wide.block);
    return visit_blocks(scene_.scene_->wide, leaf, [&](const layout::u32* rows, std::size_t n) {
      for (std::size_t first = 0; first < n; first += 4) {
        const SlotsChosen chosen = may_cross(rows + first, block);
        for (std::size_t i = first; i < std::min(n, first + 4); ++i) {
          if (!chosen[i - first]) continue;
          const std::uint32_t triangle = rows[(KDRAY_TRIANGLE_ROWS - 1) * block + i] & ~KDRAY_WIDE_LAST;
          const ExactLine::Corners corners = scene_.doubles_->at(triangle);
          if (!line.crosses(corners)) continue;
          const std::optional<double> end =
              found(ExactHit{line.t_of(corners), 0, 0, ref_of(triangle), kNoInstance});
          if (!end) return false;
          end_at(*end);
        }
      }
      return true;
    });
  }

  const DoubleScene& scene_;
  const DoubleRay& ray_;
  vec3 origin_, inverse_;
  std::uint32_t octant_ = 0;
  float margin_, begin_, end_;
  int kx_, ky_, kz_;
  float sx_, sy_, displaced_;
};

bool DoubleScene::is_seen(std::uint32_t ref, std::uint32_t mask) const {
  return mask == 0xffffffffu || (table_->mask_of(number_of(scene_->flat, ref)) & mask) != 0;
}

// Whether it comes first. In a row: exactly by t, then by number.
bool DoubleScene::precedes(const ExactLine& line, const ExactHit& a, const ExactHit& b) const {
  if (a.ref == b.ref) return false;
  if (is_sure_order(a.t, b.t)) return a.t < b.t;
  const int order =
      line.compare_t(doubles_->at(a.ref & KDRAY_REF_INDEX_MASK), doubles_->at(b.ref & KDRAY_REF_INDEX_MASK));
  if (order != 0) return order < 0;
  return number_of(scene_->flat, a.ref) < number_of(scene_->flat, b.ref);
}

ExactHit DoubleScene::finished(const ExactLine& line, const DoubleRay& ray, ExactHit hit) const {
  const auto [u, v] = line.weights_of(doubles_->at(hit.ref & KDRAY_REF_INDEX_MASK));
  hit.t = std::scalbn(hit.t, ray.exponent);
  hit.u = u, hit.v = v;
  return hit;
}

std::optional<ExactHit> DoubleScene::closest(const DoubleRay& ray, std::uint32_t mask) const {
  Walk walk(*this, ray);
  std::optional<ExactHit> best;
  walk.run([&](const ExactHit& hit) -> std::optional<double> {
    const double end = best ? best->t : ray.t_max;
    if (!(hit.t > ray.t_min && hit.t < ray.t_max) || !is_seen(hit.ref, mask)) return end;
    if (!best || precedes(walk.line, hit, *best)) best = hit;
    return best->t;
  });
  if (best) best = finished(walk.line, ray, *best);
  return best;
}

bool DoubleScene::any(const DoubleRay& ray, std::uint32_t mask) const {
  Walk walk(*this, ray);
  bool has_hit = false;
  walk.run([&](const ExactHit& hit) -> std::optional<double> {
    has_hit = hit.t > ray.t_min && hit.t < ray.t_max && is_seen(hit.ref, mask);
    return has_hit ? std::nullopt : std::optional(ray.t_max);
  });
  return has_hit;
}

void DoubleScene::all(const DoubleRay& ray, std::uint32_t mask, std::vector<ExactHit>& hits) const {
  hits.clear();
  Walk walk(*this, ray);
  walk.run([&](const ExactHit& hit) -> std::optional<double> {
    const bool is_ahead = hit.t > ray.t_min || (hit.t == 0 && ray.t_min == 0);
    if (is_ahead && hit.t < ray.t_max && is_seen(hit.ref, mask)) hits.push_back(hit);
    return ray.t_max;
  });
  // A triangle lies in several leaves.
  std::sort(hits.begin(), hits.end(), [](const ExactHit& a, const ExactHit& b) { return a.ref < b.ref; });
  const auto same = [](const ExactHit& a, const ExactHit& b) { return a.ref == b.ref; };
  hits.erase(std::unique(hits.begin(), hits.end(), same), hits.end());
  std::sort(hits.begin(), hits.end(),
            [&](const ExactHit& a, const ExactHit& b) { return precedes(walk.line, a, b); });
  for (ExactHit& hit : hits) hit = finished(walk.line, ray, hit);
}

namespace {

// The point of a triangle that is nearest to 0, by weights of its second and third corner. An edge is looked
// at from its lesser corner, whichever triangle asks: of two that share what is nearest both have the same
// distance.
struct NearPoint {
  double square;
  dvec3 point;
  double u, v;
};

NearPoint near_of_edge(const ExactLine::Corners& corners, int i, int k) {
  const auto less = [](const dvec3& a, const dvec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  if (less(corners[static_cast<std::size_t>(k)], corners[static_cast<std::size_t>(i)])) std::swap(i, k);
  const dvec3 &a = corners[static_cast<std::size_t>(i)], &b = corners[static_cast<std::size_t>(k)];
  const dvec3 e = b - a;
  const double length2 = glm::dot(e, e);
  const double s = length2 > 0 ? std::clamp(-glm::dot(a, e) / length2, 0.0, 1.0) : 0;
  const dvec3 point = s == 1 ? b : a + s * e;
  std::array<double, 3> weights{};
  weights[static_cast<std::size_t>(i)] = 1 - s;
  weights[static_cast<std::size_t>(k)] = s;
  return {glm::dot(point, point), point, weights[1], weights[2]};
}

NearPoint near_of(const ExactLine::Corners& corners) {
  const auto& [a, b, c] = corners;
  const dvec3 ab = b - a, bc = c - b, ca = a - c, n = glm::cross(ab, -ca);
  const double n2 = glm::dot(n, n);
  const double wa = glm::dot(glm::cross(b, bc), n), wb = glm::dot(glm::cross(c, ca), n),
               wc = glm::dot(glm::cross(a, ab), n);
  if (n2 > 0 && wa > 0 && wb > 0 && wc > 0) {
    const double height = glm::dot(a, n);
    return {height * (height / n2), height / n2 * n, wb / n2, wc / n2};
  }
  NearPoint best = near_of_edge(corners, 0, 1);
  for (const auto& [i, k] : {std::pair{1, 2}, std::pair{2, 0}})
    if (const NearPoint other = near_of_edge(corners, i, k); other.square < best.square) best = other;
  return best;
}

// The square of the distance from a place to each of eight boxes, or infinity where there is none.
void squares_to_boxes(const WideNode& node, const dvec3& place, double margin, float (&squares)[8]) {
  const vec3 at(place);
  const float wider = widened(margin, place);
  for (int first = 0; first < 8; first += 4) {
    Slots sum{};
    for (int k = 0; k < 3; ++k) {
      const Slots below = slots_at(node.bounds[k][0] + first) - (at[k] + wider),
                  above = (at[k] - wider) - slots_at(node.bounds[k][1] + first);
      const Slots way = greater(Slots{}, greater(below, above));
      sum += way * way;
    }
    std::memcpy(squares + first, &sum, sizeof sum);
  }
}

}  // namespace

std::optional<DoubleScene::Nearest> DoubleScene::nearest(const dvec3& place, double most) const {
  struct Entry {
    float square;
    std::uint32_t child;
    bool operator<(const Entry& other) const { return square > other.square; }
  };
  std::optional<Nearest> best;
  double square = most * most, within = most;
  if (scene_->wide.nodes.size() == 0) return best;
  // Squares of floats are off by some 4u; the boxes' margin is in them.
  constexpr double kFloats = 1 - 0x1p-20;
  std::vector<Entry> heap{{0, 0}};
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end());
    const Entry entry = heap.back();
    heap.pop_back();
    if (entry.square * kFloats > square) break;
    if (!(entry.child & KDRAY_WIDE_LEAF)) {
      const WideNode& node = scene_->wide.nodes[entry.child];
      float squares[8];
      squares_to_boxes(node, place, margin_, squares);
      for (std::size_t slot = 0; slot < 8; ++slot) {
        const bool is_there = node.bounds[0][0][slot] <= node.bounds[0][1][slot];
        if (!is_there || squares[slot] * kFloats > square) continue;
        heap.push_back({squares[slot], node.child[slot]});
        std::push_heap(heap.begin(), heap.end());
      }
      continue;
    }
    const auto block = static_cast<std::size_t>(scene_->wide.block);
    visit_blocks(scene_->wide, entry.child, [&](const layout::u32* rows, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t triangle = rows[(KDRAY_TRIANGLE_ROWS - 1) * block + i] & ~KDRAY_WIDE_LAST;
        ExactLine::Corners corners = doubles_->at(triangle);
        for (dvec3& corner : corners) corner -= place;
        const NearPoint near = near_of(corners);
        if (!(near.square <= square)) continue;
        const std::uint32_t ref = ref_of(triangle);
        const double distance = std::sqrt(near.square);
        if (best && near.square == square &&
            number_of(scene_->flat, ref) >= number_of(scene_->flat, best->ref))
          continue;
        if (distance > within) continue;
        square = near.square;
        best = Nearest{distance, near.point + place, ref, near.u, near.v};
      }
      return true;
    });
  }
  return best;
}

}  // namespace kdray::query
