#include "scene/model/normals.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>

#include "base/local_space.h"
#include "scene/model/first_fault.h"
#include "scene/model/zero_area.h"

namespace kdray::scene {

namespace {

constexpr bool is_zero(const vec3& v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

bool uses_zero(const Scene& scene, const Triangle& t) {
  return std::ranges::any_of(t.normal, [&](std::uint32_t n) { return is_zero(scene.normals[n]); });
}

std::size_t flatten(Scene& scene) {
  std::size_t n_flat = 0;
  for (Triangle& t : scene.triangles) {
    if (t.normal[0] == kNone || !uses_zero(scene, t)) continue;
    t.normal.fill(kNone);
    ++n_flat;
  }
  return n_flat;
}

}  // namespace

vec3 direction_of(const dvec3& v) {
  // The vector is scaled first, so that the squares of very short and very long ones don't vanish or
  // overflow.
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) return vec3(0);
  const dvec3 scaled = v / largest;
  if (!is_finite(scaled)) return vec3(0);
  return vec3(scaled / glm::length(scaled));
}

std::size_t settle_normals(Scene& scene, const std::string& file) {
  bool any_zero = false;
  for (vec3& n : scene.normals) {
    n = direction_of(dvec3(n));
    any_zero = any_zero || is_zero(n);
  }
  if (!any_zero) return 0;
  const std::size_t n_flat = flatten(scene);
  for (vec3& n : scene.normals) {
    if (is_zero(n)) n = vec3(0, 0, 1);
  }
  if (n_flat > 0) scene.warnings.push_back(flat_warning(file, n_flat));
  return n_flat;
}

void settle_vertices(Scene& scene, const std::function<std::string(std::size_t)>& place_of) {
  const auto good = [&](std::size_t i) { return is_finite(scene.vertices[i]); };
  const std::size_t first = first_fault(scene.vertices.size(), good);
  if (first == scene.vertices.size()) return;
  std::size_t n_triangles = 0, n_vertices = 0;
  for (Triangle& t : scene.triangles) {
    const auto bad = std::ranges::find_if(t.vertex, [&](std::uint32_t v) { return !good(v); });
    if (bad == t.vertex.end()) continue;
    t.vertex.fill(*bad);
    ++n_triangles;
  }
  for (dvec3& v : scene.vertices) {
    if (is_finite(v)) continue;
    v = dvec3(0);
    ++n_vertices;
  }
  scene.warnings.push_back(place_of(first) + ": " + std::to_string(n_vertices) +
                           " vertices are not finite (this is the first): the " +
                           std::to_string(n_triangles) + " triangles that use them are left out");
}

std::string flat_warning(const std::string& file, std::size_t n_flat) {
  return file + ": " + std::to_string(n_flat) +
         " triangles have a corner normal without a direction: they are shaded flat";
}

namespace {

constexpr std::size_t kMostFaces = 1000;

// A corner of a triangle without normals.
struct Corner {
  dvec3 place;
  std::uint32_t triangle, k;

  auto key() const { return std::tuple(place.x, place.y, place.z, triangle, k); }
};

// What a face adds to the normals around one of its corners.
struct Share {
  dvec3 normal{0};  // unit; 0: the face has none
  double angle = 0;
};

class Smoother {
 public:
  Smoother(Scene& scene, double degrees)
      : scene_(scene), least_cosine_(std::cos(degrees * std::numbers::pi / 180)) {}

  void run() {
    collect_corners();
    for (std::size_t first = 0; first < corners_.size();) {
      std::size_t last = first + 1;
      while (last < corners_.size() && corners_[last].place == corners_[first].place) ++last;
      smooth_place(std::span(corners_).subspan(first, last - first));
      first = last;
    }
    leave_flat();
  }

 private:
  void collect_corners() {
    for (std::uint32_t i = 0; i < scene_.triangles.size(); ++i) {
      const Triangle& t = scene_.triangles[i];
      if (t.normal[0] != kNone) continue;
      for (std::uint32_t k = 0; k < 3; ++k)
        corners_.push_back({scene_.vertices[t.vertex[k]] + dvec3(0), i, k});  // -0 is 0
    }
    tbb::parallel_sort(corners_, [](const Corner& a, const Corner& b) { return a.key() < b.key(); });
  }

  Share share_of(const Corner& corner) const {
    const auto& v = scene_.triangles[corner.triangle].vertex;
    const dvec3 to_next = scene_.vertices[v[(corner.k + 1) % 3]] - corner.place,
                to_last = scene_.vertices[v[(corner.k + 2) % 3]] - corner.place;
    const double scale = scale_to_one(std::max(largest_component(to_next), largest_component(to_last)));
    const dvec3 e = to_next * scale, f = to_last * scale, n = glm::cross(e, f);
    const double length = glm::length(n);
    if (!has_area(e, f)) return {};
    return {n / length, std::atan2(length, glm::dot(e, f))};
  }

  void smooth_place(std::span<const Corner> corners) {
    shares_.clear();
    for (const Corner& c : corners) shares_.push_back(share_of(c));
    const std::size_t first_normal = scene_.normals.size();
    for (std::size_t i = 0; i < corners.size(); ++i)
      scene_.triangles[corners[i].triangle].normal[corners[i].k] = number_of(normal_at(i), first_normal);
  }

  // A triangle without area has no side of its own: it takes the sum of all that is there.
  vec3 normal_at(std::size_t i) const {
    const dvec3& own = shares_[i].normal;
    const double least = own == dvec3(0) ? -1 : least_cosine_;
    dvec3 sum = own * shares_[i].angle;
    if (shares_.size() <= kMostFaces)
      for (std::size_t j = 0; j < shares_.size(); ++j)
        if (j != i && glm::dot(own, shares_[j].normal) >= least) sum += shares_[j].normal * shares_[j].angle;
    const double length = glm::length(sum);
    return length > 0 ? vec3(sum / length) : vec3(0);
  }

  // Triangles with a corner that has no normal: of those without area, where all there have none.
  void leave_flat() {
    for (const Corner& c : corners_) {
      auto& normal = scene_.triangles[c.triangle].normal;
      if (normal[c.k] == kNone) normal.fill(kNone);
    }
  }

  // Corners of one place share a normal that is the same.
  std::uint32_t number_of(const vec3& normal, std::size_t first) {
    if (normal == vec3(0)) return kNone;
    const std::size_t back = std::min<std::size_t>(scene_.normals.size() - first, 16);
    for (std::size_t i = scene_.normals.size() - back; i < scene_.normals.size(); ++i)
      if (scene_.normals[i] == normal) return static_cast<std::uint32_t>(i);
    scene_.normals.push_back(normal);
    return static_cast<std::uint32_t>(scene_.normals.size() - 1);
  }

  Scene& scene_;
  double least_cosine_;
  std::vector<Corner> corners_;
  std::vector<Share> shares_;  // of the corners of one place
};

}  // namespace

void smooth_normals(Scene& scene, double degrees) {
  Smoother(scene, degrees).run();
}

}  // namespace kdray::scene
