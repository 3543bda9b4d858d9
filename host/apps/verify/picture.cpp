// What    The picture of where the findings are.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/verify/tracer.h"
#include "apps/verify/verify.h"

namespace kdray::verify {

namespace {

// Colours are linear light.
constexpr vec3 kPaper{0.91f, 0.91f, 0.9f};
constexpr vec3 kOpen{0.8f, 0.0f, 0.0f}, kCrowded{0.0f, 0.12f, 0.85f}, kFlipped{0.95f, 0.3f, 0.0f},
    kDoubled{0.55f, 0.0f, 0.6f}, kOverlapping{0.0f, 0.35f, 0.12f}, kDefect{0.0f, 0.0f, 0.0f};
constexpr float kThrough = 0.35f;  // how much is seen of what lies behind something

// Returns the colours of the faces to fill, by the primitive's number.
std::vector<const vec3*> fills_of(const Findings& f, std::size_t n_primitives) {
  std::vector<const vec3*> fills(n_primitives);
  const auto fill = [&](std::uint32_t face, const vec3& color) { fills[f.mesh.numbers[face]] = &color; };
  for (const auto& [a, b] : f.duplicates.overlapping) fill(a, kOverlapping), fill(b, kOverlapping);
  for (const std::uint32_t face : f.topology.flipped) fill(face, kFlipped);
  for (const std::uint32_t face : f.duplicates.doubled) fill(face, kDoubled);
  return fills;
}

struct View {
  dvec3 eye, right, up, forward;
  double scale;  // pixels to the tangent of the angle

  View(const dvec3& from, const dvec3& at, const dvec3& wanted_up, double fov, int height) : eye(from) {
    forward = glm::normalize(at - from);
    dvec3 side = glm::cross(forward, wanted_up);
    if (!(glm::length(side) > 1e-9)) side = glm::cross(forward, dvec3(forward.y, forward.z, forward.x));
    right = glm::normalize(side);
    up = glm::cross(right, forward);
    scale = 0.5 * height / std::tan(0.5 * fov);
  }
};

// Returns the scene's own view, and one from the other side of it.
std::vector<View> views_of(const prepare::Prepared& scene, int height) {
  const scene::Camera camera = scene.settings.camera.value_or(scene::Camera{});
  std::vector<View> views = {{camera.from, camera.at, camera.up, camera.vertical_fov, height}};
  const Box& b = scene.geometry.bounds;
  const dvec3 middle = b.empty() ? dvec3(0) : 0.5 * dvec3(b.lo) + 0.5 * dvec3(b.hi);
  const double radius = b.empty() ? 1 : 0.5 * glm::length(dvec3(b.hi) - dvec3(b.lo));
  dvec3 away = middle - camera.from;
  if (!(glm::length(away) > 0)) away = camera.at - camera.from;
  constexpr double kFov = 0.7;
  const double distance = std::max(radius, 1e-30) / std::sin(0.5 * kFov);
  views.push_back({middle + distance * glm::normalize(away), middle, camera.up, kFov, height});
  return views;
}

// One of the views in the picture.
class Panel {
 public:
  Panel(image::Image& image, int x, int width, int height, const View& view)
      : image_(image), x_(x), width_(width), height_(height), view_(view) {}

  void shade(Tracer& tracer, const std::vector<const vec3*>& fills) {
    std::vector<Ray> rays(size());
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) rays[index(x, y)] = ray_through(x, y);
    const std::vector<Hit> hits = tracer.closest(rays);
    std::vector<Ray> struck;
    std::vector<Hit> strikes;
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i].primitive >= 0) struck.push_back(rays[i]), strikes.push_back(hits[i]);
    const std::vector<layout::Departure> departures = tracer.departures(struck, strikes);
    depth_.assign(size(), std::numeric_limits<double>::infinity());
    marks_.assign(size(), {});
    for (std::size_t i = 0, hit = 0; i < hits.size(); ++i) {
      if (hits[i].primitive < 0) continue;
      const auto& n = departures[hit++].normal;
      const auto& d = rays[i].direction;
      const float facing = std::abs(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
      const vec3* const fill = fills[static_cast<std::size_t>(hits[i].primitive)];
      depth_[i] = hits[i].t;
      pixel(i) = fill ? *fill * (0.5f + 0.5f * facing) : vec3(0.3f + 0.4f * facing);
    }
  }

  // Draws a disc of this radius where the point is seen.
  void dot(const dvec3& point, double radius, const vec3& color) {
    const std::optional<Projected> at = project(point);
    if (!at) return;
    const bool hidden = !is_visible(*at);
    const int r = static_cast<int>(std::ceil(radius));
    for (int v = -r; v <= r; ++v)
      for (int u = -r; u <= r; ++u)
        if (u * u + v * v <= radius * radius) paint(at->x + u, at->y + v, color, hidden);
  }

  void line(const dvec3& a, const dvec3& b, const vec3& color) {
    const std::optional<Projected> p = project(a), q = project(b);
    const double length = p && q ? std::max(std::abs(p->x - q->x), std::abs(p->y - q->y)) : 2.0 * width_;
    const int steps = static_cast<int>(std::min(std::ceil(length), 4.0 * width_));
    for (int i = 0; i <= steps; ++i)
      dot(glm::mix(a, b, steps > 0 ? static_cast<double>(i) / steps : 0.5), 1.5, color);
  }

  void cross(const dvec3& point, const vec3& color) {
    const std::optional<Projected> at = project(point);
    if (!at) return;
    for (int i = -6; i <= 6; ++i)
      for (int thick = 0; thick < 2; ++thick) {
        paint(at->x + i + thick, at->y + i, color, false);
        paint(at->x + i + thick, at->y - i, color, false);
      }
  }

  // Whether the face's points are closer together than this many pixels.
  bool is_smaller_than(const Mesh& mesh, std::uint32_t face, double pixels) const {
    const std::optional<Projected> at = project(dvec3(mesh.corner(face, 0)));
    if (!at) return true;
    const double size = glm::length(dvec3(mesh.bounds_of(face).extent()));
    return size / at->distance * view_.scale < pixels;
  }

  // Puts the marks onto the picture. Of several on one pixel the last that isn't hidden shows, or the last of
  // all where all are.
  void finish() {
    for (std::size_t i = 0; i < size(); ++i) {
      if (marks_[i].seen > 0) pixel(i) = glm::mix(pixel(i), marks_[i].color, marks_[i].seen);
    }
  }

 private:
  struct Mark {
    vec3 color{0};
    float seen = 0;
  };
  struct Projected {
    int x, y;
    double distance;
  };

  std::size_t size() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  vec3& pixel(std::size_t i) {
    const std::size_t x = i % static_cast<std::size_t>(width_), y = i / static_cast<std::size_t>(width_);
    return image_.pixels[y * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x_) + x];
  }

  Ray ray_through(int x, int y) const {
    const dvec3 d = glm::normalize(view_.scale * view_.forward + (x + 0.5 - 0.5 * width_) * view_.right -
                                   (y + 0.5 - 0.5 * height_) * view_.up);
    const vec3 o(view_.eye), f(d);
    return {{o.x, o.y, o.z}, 0, {f.x, f.y, f.z}, std::numeric_limits<float>::infinity()};
  }

  std::optional<Projected> project(const dvec3& point) const {
    const dvec3 way = point - view_.eye;
    const double ahead = glm::dot(way, view_.forward);
    if (!(ahead > 0)) return {};
    const double x = 0.5 * width_ + view_.scale * glm::dot(way, view_.right) / ahead;
    const double y = 0.5 * height_ - view_.scale * glm::dot(way, view_.up) / ahead;
    if (!(x >= 0 && x < width_ && y >= 0 && y < height_)) return {};
    return Projected{static_cast<int>(x), static_cast<int>(y), glm::length(way)};
  }

  // Whether the place is seen: in its pixel or one beside it the first surface lies no nearer than the place
  // does, give or take a little for the slope of its own surface.
  bool is_visible(const Projected& at) const {
    for (int v = std::max(at.y - 1, 0); v <= std::min(at.y + 1, height_ - 1); ++v)
      for (int u = std::max(at.x - 1, 0); u <= std::min(at.x + 1, width_ - 1); ++u)
        if (at.distance <= 1.002 * depth_[index(u, v)]) return true;
    return false;
  }

  void paint(int x, int y, const vec3& color, bool hidden) {
    if (x < 0 || x >= width_ || y < 0 || y >= height_) return;
    Mark& mark = marks_[index(x, y)];
    if (!hidden || mark.seen < 1) mark = {color, hidden ? kThrough : 1.0f};
  }

  image::Image& image_;
  const int x_, width_, height_;
  const View view_;
  std::vector<double> depth_;  // of each pixel, from the eye
  std::vector<Mark> marks_;
};

dvec3 middle_of(const Mesh& mesh, std::uint32_t face) {
  return (dvec3(mesh.corner(face, 0)) + dvec3(mesh.corner(face, 1)) + dvec3(mesh.corner(face, 2))) / 3.0;
}

void mark_findings(const Findings& f, const std::vector<const vec3*>& fills, Panel& panel) {
  constexpr double kSmall = 8, kDot = 3;
  const Mesh& mesh = f.mesh;
  const auto edges = [&](const std::vector<Edge>& which, const vec3& color) {
    for (const Edge& e : which) panel.line(dvec3(mesh.points[e.a]), dvec3(mesh.points[e.b]), color);
  };
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const vec3* const fill = fills[mesh.numbers[face]];
    if (!fill) continue;
    panel.dot(middle_of(mesh, face), panel.is_smaller_than(mesh, face, kSmall) ? kDot : 1, *fill);
  }
  if (f.topology.flipped.empty()) edges(f.topology.turned, kFlipped);
  edges(f.topology.crowded, kCrowded);
  edges(f.topology.open, kOpen);
  for (const Witness& w : f.probes.witnesses) panel.cross(dvec3(w.where), kDefect);
  panel.finish();
}

}  // namespace

image::Image draw(const Findings& found, const prepare::Prepared& scene, Tracer& tracer, int width,
                  int height) {
  image::Image image{width, height, {}};
  image.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kPaper);
  const std::vector<const vec3*> fills = fills_of(found, scene.counts.primitives);
  int x = 0;
  for (const View& view : views_of(scene, height)) {
    Panel panel(image, x, width / 2 - 2, height, view);
    panel.shade(tracer, fills);
    mark_findings(found, fills, panel);
    x += width / 2 + 2;
  }
  return image;
}

std::string colors_of(const Findings& f) {
  std::string words;
  const auto add = [&](bool found, const char* what) {
    if (found) words += (words.empty() ? "" : ", ") + std::string(what);
  };
  const Topology& t = f.topology;
  add(!t.open.empty(), "red: open edges");
  add(!t.crowded.empty(), "blue: edges of three or more faces");
  add(!t.flipped.empty(), "orange: flipped faces");
  add(t.flipped.empty() && !t.turned.empty(), "orange: edges where the side turns");
  add(!f.duplicates.doubled.empty(), "purple: faces there twice");
  add(!f.duplicates.overlapping.empty(), "green: overlapping pairs");
  add(f.probes.defects() > 0, "black: faults of kdray");
  return words;
}

}  // namespace kdray::verify
