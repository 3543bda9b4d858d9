// What    Small meshes of known faults, as scenes.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "apps/verify/edges.h"
#include "apps/verify/mesh.h"
#include "scene/model/geometry.h"

namespace kdray::verify {

// A scene put together face by face; every face has corners of its own, so that welding is always at work.
class Builder {
 public:
  Builder() {
    scene_.materials.emplace_back();
    scene_.camera = scene::Camera{};
  }
  Builder& face(const dvec3& a, const dvec3& b, const dvec3& c) {
    scene::Triangle t{};
    t.number = scene_.primitive_count();
    for (const dvec3& p : {a, b, c}) {
      t.vertex[scene_.vertices.size() % 3] = static_cast<std::uint32_t>(scene_.vertices.size());
      scene_.vertices.push_back(p);
    }
    scene_.triangles.push_back(t);
    return *this;
  }
  // Counter-clockwise from the front.
  Builder& quad(const dvec3& corner, const dvec3& x, const dvec3& y) {
    face(corner, corner + x, corner + x + y);
    return face(corner, corner + x + y, corner + y);
  }
  Builder& sphere(const dvec3& center, double radius) {
    scene_.spheres.push_back({center, radius, 0, scene_.primitive_count()});
    return *this;
  }
  Builder& cone(const dvec3& base, double r0, const dvec3& apex, double r1) {
    scene_.cones.push_back({base, apex, r0, r1, 0, scene_.primitive_count()});
    return *this;
  }
  // Twelve faces, the first two those of the side at the smallest z.
  Builder& cube(const dvec3& lo, double size) {
    const dvec3 x(size, 0, 0), y(0, size, 0), z(0, 0, size);
    quad(lo, y, x).quad(lo + z, x, y);
    quad(lo, x, z).quad(lo + y, z, x);
    return quad(lo, z, y).quad(lo + x, y, z);
  }
  // A ball of 2*n*n faces; its poles are corners of n slivers each.
  Builder& ball(const dvec3& center, double radius, int n) {
    const auto at = [&](int i, int j) {
      if (i == 0 || i == n) return center + dvec3(0, 0, i == 0 ? radius : -radius);
      const double u = std::numbers::pi * i / n, v = std::numbers::pi * (j % n) / (n / 2.0);
      return center + radius * dvec3(std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u));
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        if (i < n - 1) face(at(i, j), at(i + 1, j), at(i + 1, j + 1));
        if (i > 0) face(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      }
    return *this;
  }
  // A strip with half a turn in it.
  Builder& moebius(int n) {
    const auto at = [n](int i, double side) {
      const double u = 2 * std::numbers::pi * (i % n) / n, turn = std::numbers::pi * i / n,
                   across = side * 0.3;
      return dvec3(std::cos(u) * (1 + across * std::cos(turn)), std::sin(u) * (1 + across * std::cos(turn)),
                   across * std::sin(turn));
    };
    // Where it closes the sides have changed places: the very corners, not others nearly there.
    const auto corner = [&](int i, double side) { return i == n ? at(0, -side) : at(i, side); };
    for (int i = 0; i < n; ++i) {
      face(corner(i, -1), corner(i + 1, -1), corner(i + 1, 1));
      face(corner(i, -1), corner(i + 1, 1), corner(i, 1));
    }
    return *this;
  }
  Builder& moved(const dvec3& by) {
    for (dvec3& v : scene_.vertices) v += by;
    return *this;
  }
  scene::Scene& scene() { return scene_; }

 private:
  scene::Scene scene_;
};

struct Meshed {
  explicit Meshed(const scene::Scene& scene)
      : geometry(scene::make_geometry(scene)),
        mesh(make_mesh(scene, geometry)),
        boxes(mesh),
        topology(find_topology(mesh)) {}
  explicit Meshed(Builder& b) : Meshed(b.scene()) {}

  // Of the scene, in the space that the mesh is in; and back.
  dvec3 local(const dvec3& p) const { return geometry.space.local(p); }
  double local(double length) const { return geometry.space.local_length(length); }
  double volume(std::size_t component) const {
    return topology.components[component].volume / std::pow(geometry.space.scale, 3);
  }

  scene::Geometry geometry;
  Mesh mesh;
  Boxes boxes;
  Topology topology;
};

inline void turn_over(scene::Triangle& t) {
  std::swap(t.vertex[1], t.vertex[2]);
}

}  // namespace kdray::verify
