#include "scene/model/tangents.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <vector>

#include "base/local_space.h"

namespace kdray::scene {

namespace {

constexpr double kOffset = KDRAY_TANGENT_OFFSET;

double with_sign_of(double v, double sign) {
  return sign < 0 ? -v : v;
}

}  // namespace

std::array<float, 2> packed_tangent(const Tangent& tangent) {
  const dvec3& d = tangent.direction;
  const double size = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  if (!(size > 0) || !std::isfinite(size)) return {0, 0};
  double a = d.x / size, b = d.y / size;
  if (d.z < 0) {
    const double folded = with_sign_of(1 - std::abs(b), a);
    b = with_sign_of(1 - std::abs(a), b);
    a = folded;
  }
  return {static_cast<float>(a), static_cast<float>(with_sign_of(b + kOffset, tangent.hand))};
}

Tangent unpacked_tangent(const float* packed) {
  if (packed[1] == 0) return {};
  double a = packed[0], b = std::abs(double{packed[1]}) - kOffset;
  const double z = 1 - std::abs(a) - std::abs(b);
  if (z < 0) {
    const double folded = with_sign_of(1 - std::abs(b), a);
    b = with_sign_of(1 - std::abs(a), b);
    a = folded;
  }
  return {glm::normalize(dvec3(a, b, z)), packed[1] < 0 ? -1.0 : 1.0};
}

void move_tangents(const dmat3& linear, PageVector<layout::TexCoords>& tangents) {
  // At a size of about 1, so that no product leaves double's range.
  const double size =
      std::max({largest_component(linear[0]), largest_component(linear[1]), largest_component(linear[2])});
  const double side = glm::determinant(linear * scale_to_one(size)) < 0 ? -1 : 1;
  for (layout::TexCoords& at : tangents)
    for (auto& corner : at.uv) {
      Tangent t = unpacked_tangent(corner);
      t = {safe_normalize(linear * t.direction), t.hand * side};
      const std::array<float, 2> packed = packed_tangent(t);
      corner[0] = packed[0], corner[1] = packed[1];
    }
}

namespace {

// A corner of a triangle that has a tangent of its own.
struct TangentCorner {
  dvec3 place;
  vec3 normal;
  float u, v;
  bool mirrored;
  std::uint32_t triangle, k;

  auto meets() const {
    return std::tuple(place.x, place.y, place.z, normal.x, normal.y, normal.z, u, v, mirrored);
  }
  auto key() const { return std::tuple_cat(meets(), std::tuple(triangle, k)); }
};

// The direction in which u grows on a triangle, and whether its picture is mirrored on it.
struct Own {
  dvec3 way{0};  // 0: there is none
  bool mirrored = false;
};

dvec3 onto_plane(const dvec3& v, const dvec3& normal) {
  return v - normal * glm::dot(normal, v);
}

class TangentSmoother {
 public:
  TangentSmoother(Scene& scene, std::size_t first, std::size_t set)
      : scene_(scene), first_(first), uv_(scene.texturing.texcoords[set]), out_(scene.texturing.tangents) {}

  void run() {
    out_.resize(scene_.triangles.size());
    for (std::size_t i = first_; i < std::min(scene_.triangles.size(), uv_.size()); ++i) collect(i);
    tbb::parallel_sort(corners_,
                       [](const TangentCorner& a, const TangentCorner& b) { return a.key() < b.key(); });
    for (std::size_t first = 0; first < corners_.size();) {
      std::size_t last = first + 1;
      while (last < corners_.size() && corners_[last].meets() == corners_[first].meets()) ++last;
      smooth(std::span(corners_).subspan(first, last - first));
      first = last;
    }
  }

 private:
  dvec3 place(std::size_t triangle, std::size_t k) const {
    return scene_.vertices[scene_.triangles[triangle].vertex[k]];
  }

  Own own_of(std::size_t i) const {
    const auto& at = uv_[i].uv;
    const double du1 = double{at[1][0]} - at[0][0], dv1 = double{at[1][1]} - at[0][1];
    const double du2 = double{at[2][0]} - at[0][0], dv2 = double{at[2][1]} - at[0][1];
    const double det = du1 * dv2 - du2 * dv1;
    if (det == 0) return {};
    const double scale = det < 0 ? -1 : 1;
    const dvec3 way = ((place(i, 1) - place(i, 0)) * dv2 - (place(i, 2) - place(i, 0)) * dv1) * scale;
    return {way == dvec3(0) || !is_finite(way) ? dvec3(0) : safe_normalize(way), det > 0};
  }

  void collect(std::size_t i) {
    const Triangle& t = scene_.triangles[i];
    const Own own = own_of(i);
    if (t.normal[0] == kNone || own.way == dvec3(0)) return;
    // A normal that has no direction yet (normals.h) would have no order among the others.
    for (const std::uint32_t n : t.normal)
      if (!is_finite(dvec3(scene_.normals[n]))) return;
    for (std::uint32_t k = 0; k < 3; ++k)
      corners_.push_back({place(i, k) + dvec3(0), scene_.normals[t.normal[k]] + vec3(0), uv_[i].uv[k][0],
                          uv_[i].uv[k][1], own.mirrored, static_cast<std::uint32_t>(i), k});
  }

  // Returns what a triangle gives to the mean at one of its corners.
  dvec3 share_of(const TangentCorner& c) const {
    const dvec3 normal(c.normal), own = onto_plane(own_of(c.triangle).way, normal);
    const dvec3 to_next = onto_plane(place(c.triangle, (c.k + 1) % 3) - c.place, normal),
                to_last = onto_plane(place(c.triangle, (c.k + 2) % 3) - c.place, normal);
    const double scale = scale_to_one(std::max(largest_component(to_next), largest_component(to_last)));
    const dvec3 e = to_next * scale, f = to_last * scale;
    const double length = glm::length(own), angle = std::atan2(glm::length(glm::cross(e, f)), glm::dot(e, f));
    return length > 0 && angle > 0 ? own * (angle / length) : dvec3(0);
  }

  void smooth(std::span<const TangentCorner> corners) {
    dvec3 sum(0);
    for (const TangentCorner& c : corners) sum += share_of(c);
    const double length = glm::length(sum);
    if (!(length > 0)) return;
    const Tangent tangent{sum / length, corners.front().mirrored ? -1.0 : 1.0};
    const auto packed = packed_tangent(tangent);
    for (const TangentCorner& c : corners) std::ranges::copy(packed, out_[c.triangle].uv[c.k]);
  }

  Scene& scene_;
  std::size_t first_;
  const PageVector<layout::TexCoords>& uv_;
  PageVector<layout::TexCoords>& out_;
  std::vector<TangentCorner> corners_;
};

}  // namespace

void smooth_tangents(Scene& scene, std::size_t first, std::size_t set) {
  TangentSmoother(scene, first, set).run();
}

}  // namespace kdray::scene
