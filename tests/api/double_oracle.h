// What    Meshes of odd doubles, rays aimed at them, and what GMP's rationals say of what these cross.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "api/rationals.h"
#include "kdray/kdray.h"

namespace kdray::test::doubles {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct DoubleMesh {
  std::vector<Point> vertices;
  std::vector<std::uint32_t> triangles;

  const Point& corner(std::size_t triangle, std::size_t i) const {
    return vertices[triangles[3 * triangle + i]];
  }
  std::size_t size() const { return triangles.size() / 3; }
  Points points() const { return {&vertices.front()[0], vertices.size(), sizeof(Point)}; }
};

// A closed ring of odd doubles, of this size about this centre.
inline DoubleMesh ring(std::uint32_t n, std::uint32_t m, const Point& center, double size,
                       std::mt19937& random) {
  std::uniform_real_distribution<double> shaken(-0.01, 0.01);
  DoubleMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < m; ++k) {
      const double a = 6.283185307 * i / n, b = 6.283185307 * k / m, r = 0.7 + 0.25 * std::cos(b);
      const Point p{r * std::cos(a), r * std::sin(a), 0.25 * std::sin(b)};
      Point at;
      for (std::size_t c = 0; c < 3; ++c) at[c] = center[c] + size * (p[c] + shaken(random));
      mesh.vertices.push_back(at);
      const std::uint32_t next_i = (i + 1) % n, next_k = (k + 1) % m;
      const std::uint32_t p0 = i * m + k, q = next_i * m + k, r2 = next_i * m + next_k, s = i * m + next_k;
      for (const std::uint32_t v : {p0, q, r2, p0, r2, s}) mesh.triangles.push_back(v);
    }
  return mesh;
}

inline void add(DoubleMesh& to, const DoubleMesh& other) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const std::uint32_t v : other.triangles) to.triangles.push_back(first + v);
}

// Sheets 1e-9 apart, and one that is there twice.
inline DoubleMesh sheets() {
  DoubleMesh mesh;
  for (const double z : {0.0, 1e-9, 2e-9, 2e-9, 3e-9}) {
    DoubleMesh sheet;
    sheet.vertices = {
        {1e3 - 1, 1e3 - 1, z}, {1e3 + 1, 1e3 - 1, z + 1e-10}, {1e3 + 1, 1e3 + 1, z}, {1e3 - 1, 1e3 + 1, z}};
    sheet.triangles = {0, 1, 2, 0, 2, 3};
    add(mesh, sheet);
  }
  return mesh;
}

// ---- What the rationals say

struct Crossing {
  mpq_class t;
  std::uint32_t triangle;
  double u, v;
};

class Line {
 public:
  Line(const Point& origin, const Point& direction) : o_(exact(origin)), d_(exact(direction)) {
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(direction[k]) >= std::abs(direction[kz_])) kz_ = k;
    kx_ = (kz_ + 1) % 3, ky_ = (kz_ + 2) % 3;
  }

  // All that the line crosses, in its order.
  std::vector<Crossing> crossings(const DoubleMesh& mesh) const {
    std::vector<Crossing> found;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
      Exact v[3];
      for (std::size_t k = 0; k < 3; ++k) v[k] = minus(exact(mesh.corner(i, k)), o_);
      const int side = side_of(v[0], v[1]);
      if (side == 0 || side != side_of(v[1], v[2]) || side != side_of(v[2], v[0])) continue;
      const mpq_class all = volume(v[0], v[1], d_) + volume(v[1], v[2], d_) + volume(v[2], v[0], d_);
      found.push_back({volume(v[0], v[1], v[2]) / all, i, mpq_class(volume(v[2], v[0], d_) / all).get_d(),
                       mpq_class(volume(v[0], v[1], d_) / all).get_d()});
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.t < b.t; });
    return found;
  }

 private:
  std::array<mpq_class, 2> place(const Exact& p) const {
    return {p[kx_] * d_[kz_] - p[kz_] * d_[kx_], p[ky_] * d_[kz_] - p[kz_] * d_[ky_]};
  }
  int side_of(const Exact& from, const Exact& to) const {
    const auto p = place(from), q = place(to);
    const mpq_class edge = q[0] * p[1] - q[1] * p[0];
    if (edge != 0) return sgn(edge);
    return q[1] != p[1] ? cmp(q[1], p[1]) > 0 ? 1 : -1 : sgn(mpq_class(p[0] - q[0]));
  }

  Exact o_, d_;
  std::size_t kx_, ky_, kz_ = 0;
};

// How many of a double's last places it is off.
inline double places_off(double got, const mpq_class& exact) {
  const double about = exact.get_d(), place = std::nextafter(std::abs(about), kInfinity) - std::abs(about);
  return std::abs(mpq_class((mpq_class(got) - exact) / mpq_class(place)).get_d());
}

// ---- Rays

struct RayList {
  std::vector<Point> origins, directions;
  std::vector<double> t_min, t_max;  // of all, or none
  Rays rays() const {
    Rays rays{{&origins.front()[0], origins.size(), sizeof(Point)},
              {&directions.front()[0], directions.size(), sizeof(Point)}};
    if (!t_max.empty()) rays.t_min = t_min, rays.t_max = t_max;
    return rays;
  }
};

// From near and far: at vertices, at places of edges and faces, along axes through vertices, and anywhere.
inline RayList aimed(const DoubleMesh& mesh, std::size_t n, double size, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1), way(-1, 1);
  RayList list;
  while (list.origins.size() < n) {
    const std::size_t triangle = random() % mesh.size(), kind = random() % 5;
    const double u = share(random), v = kind == 1 ? 0 : share(random) * (1 - u);
    Point at = mesh.corner(triangle, 0), origin, direction;
    const double far = std::pow(10.0, std::uniform_int_distribution<int>(0, 3)(random)) * size;
    for (std::size_t k = 0; k < 3; ++k) {
      if (kind == 1 || kind == 2)
        at[k] += u * (mesh.corner(triangle, 1)[k] - at[k]) + v * (mesh.corner(triangle, 2)[k] - at[k]);
      origin[k] = at[k] + far * way(random);
    }
    if (kind == 3) {  // the line goes through the vertex exactly
      const std::size_t axis = random() % 3;
      origin = at;
      origin[axis] -= far;
      direction = {0, 0, 0};
      direction[axis] = 1;
    } else {
      for (std::size_t k = 0; k < 3; ++k) direction[k] = kind == 4 ? way(random) : at[k] - origin[k];
    }
    list.origins.push_back(origin);
    list.directions.push_back(direction);
  }
  return list;
}

// Beside edges, and from beside faces, by about as much as floats are off.
inline RayList beside(const DoubleMesh& mesh, std::size_t n, double size, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1), way(-1, 1);
  RayList list;
  while (list.origins.size() < n) {
    const std::size_t triangle = random() % mesh.size();
    const double u = share(random), v = random() % 2 ? 0 : share(random) * (1 - u);
    const double off = size * std::ldexp(way(random), -18 - static_cast<int>(random() % 10));
    const double far = random() % 2 ? off : size * std::pow(4.0, static_cast<int>(random() % 8) - 3);
    Point at = mesh.corner(triangle, 0), origin, direction;
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] += u * (mesh.corner(triangle, 1)[k] - at[k]) + v * (mesh.corner(triangle, 2)[k] - at[k]);
      direction[k] = way(random);
      origin[k] = at[k] + off * way(random) - far * direction[k];
    }
    list.origins.push_back(origin);
    list.directions.push_back(direction);
  }
  return list;
}

}  // namespace kdray::test::doubles
