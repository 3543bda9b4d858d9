#include "scene/model/instances.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/local_space.h"
#include "layout/tree.layout.h"
#include "scene/model/scene.h"
#include "scene/model/tangents.h"

namespace kdray::scene {

namespace {

dvec3 transform_point(const dmat4& m, const dvec3& p) {
  return dvec3(m * glm::dvec4(p, 1));
}

// How far from a similarity (rotation, mirror, uniform scale) a matrix may be and be taken for one: rotations
// in floats, or written to six digits, are within it.
constexpr double kNotQuite = 0x1p-18;

// Returns the factor by which a similarity enlarges; throws for any other matrix.
double similarity_factor(const dmat3& m, const std::string& what) {
  const double factor = glm::length(m[0]);
  const dmat3 square = glm::transpose(m) * m;
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      worst = std::max(worst, std::abs(square[i][j] - (i == j ? factor * factor : 0)));
    }
  }
  if (!(worst <= kNotQuite * factor * factor)) {
    throw std::domain_error(what + " can be moved, turned and scaled alike along all axes only");
  }
  return factor;
}

// What is in front stays there when all is mirrored: the second and third corners change places, with all
// that is at them.
void turn_round(Scene& scene) {
  for (Triangle& t : scene.triangles) {
    std::swap(t.vertex[1], t.vertex[2]);
    std::swap(t.normal[1], t.normal[2]);
  }
  for (layout::CornerColors& colors : scene.texturing.colors) std::swap(colors.c[1], colors.c[2]);
  for (auto* const set :
       {&scene.texturing.texcoords[0], &scene.texturing.texcoords[1], &scene.texturing.tangents})
    for (layout::TexCoords& at : *set) std::swap(at.uv[1], at.uv[2]);
}

}  // namespace

void apply_transform(const dmat4& m, Scene& scene) {
  const dmat3 linear(m);
  for (dvec3& p : scene.vertices) p = transform_point(m, p);
  // Columns of a length of about 1, so that no product leaves double's range.
  const dvec3 to_one(scale_to_one(largest_component(linear[0])), scale_to_one(largest_component(linear[1])),
                     scale_to_one(largest_component(linear[2])));
  const dmat3 unit(linear[0] * to_one[0], linear[1] * to_one[1], linear[2] * to_one[2]);
  if (!scene.normals.empty()) {
    const dmat3 of_normals = glm::transpose(glm::inverse(unit));
    const double most = largest_component(to_one);
    for (vec3& n : scene.normals) n = vec3(safe_normalize(of_normals * (to_one / most * dvec3(n))));
  }
  move_tangents(linear, scene.texturing.tangents);
  if (glm::determinant(unit) < 0) turn_round(scene);
  primitives::for_each_shape([&](auto kind) {
    auto& shapes = decltype(kind)::of(scene);
    if (shapes.empty()) return;
    const primitives::Similarity similarity{m, similarity_factor(linear, decltype(kind)::kNames)};
    for (auto& shape : shapes) transform(similarity, shape);
  });
}

dmat4 translation(const dvec3& by) {
  return glm::translate(dmat4(1), by);
}
dmat4 scaling(const dvec3& by) {
  return glm::scale(dmat4(1), by);
}
dmat4 rotation(const dvec3& unit_axis, double radians) {
  return glm::rotate(dmat4(1), radians, unit_axis);
}

namespace {

thread_local Instances wanted = Instances::automatic;

// The most primitives that copies may add, beyond the first of each mesh, before they are instances.
constexpr std::uint64_t kFewCopied = std::uint64_t{1} << 20;

double largest_row(const dmat3& m) {
  double largest = 0;
  for (int row = 0; row < 3; ++row)
    largest = std::max(largest, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
  return largest;
}

}  // namespace

Instance instance_of(const dmat4& to_world, std::uint32_t mesh) {
  return {.linear = dmat3(to_world), .move = dvec3(to_world[3]), .mesh = mesh};
}

double condition_of(const dmat3& linear) {
  const double size = largest_row(linear);
  if (!(size > 0) || !std::isfinite(size)) return std::numeric_limits<double>::infinity();
  const dmat3 unit = linear / size;  // so that the determinant neither vanishes nor overflows
  const double volume = std::abs(glm::determinant(unit));
  if (!(volume > 1e-15)) return std::numeric_limits<double>::infinity();
  return largest_row(unit) * largest_row(glm::inverse(unit));
}

const char* fault_of(const Instance& instance) {
  for (int k = 0; k < 3; ++k)
    if (!is_finite(instance.linear[k])) return "a transform that is not finite";
  if (!is_finite(instance.move)) return "a transform that is not finite";
  const double condition = condition_of(instance.linear);
  if (std::isinf(condition)) return "a transform that flattens the mesh";
  if (condition > kMostCondition)
    return "a transform that stretches one direction over 48 times as much as another";
  return nullptr;
}

DBox bounds_of(const Instance& instance, const DBox& mesh) {
  DBox box;
  if (mesh.empty()) return box;
  for (int corner = 0; corner < 8; ++corner)
    box.grow(instance.point({corner & 1 ? mesh.hi.x : mesh.lo.x, corner & 2 ? mesh.hi.y : mesh.lo.y,
                             corner & 4 ? mesh.hi.z : mesh.lo.z}));
  return box;
}

bool worth_keeping(std::uint64_t primitives, std::uint64_t copies) {
  if (wanted != Instances::automatic) return wanted == Instances::kept && copies > 0;
  return copies > 1 && primitives > kFewCopied / (copies - 1);
}

namespace {

// What there would be of a scene with copies.
struct Amount {
  std::uint64_t primitives, vertices, normals;

  explicit Amount(const Scene& scene)
      : primitives(scene.primitive_count()), vertices(scene.vertices.size()), normals(scene.normals.size()) {}
  void add(const Amount& mesh) {
    primitives += mesh.primitives, vertices += mesh.vertices, normals += mesh.normals;
  }
};

void check_capacity(const Amount& all, const Scene& scene) {
  if (all.primitives >= KDRAY_REF_INDEX_MASK || all.vertices >= kNone || all.normals >= kNone)
    throw input_error(scene.name, 0, "copies of its meshes make 2^28 primitives or more",
                      "don't make instances flat, or ask about it in floats");
}

dmat4 matrix_of(const Instance& instance) {
  dmat4 m(instance.linear);
  m[3] = glm::dvec4(instance.move, 1);
  return m;
}

}  // namespace

void add_copy(const Scene& mesh, const Instance& instance, Scene& scene) {
  Amount all(scene);
  all.add(Amount(mesh));
  check_capacity(all, scene);
  Scene part;
  part.vertices = mesh.vertices;
  part.normals = mesh.normals;
  part.triangles = mesh.triangles;
  primitives::for_each_shape([&](auto kind) { decltype(kind)::of(part) = decltype(kind)::of(mesh); });
  part.texturing = mesh.texturing;  // what it has at corners goes with the triangles
  apply_transform(matrix_of(instance), part);
  const std::uint32_t number = scene.primitive_count();
  const auto first_vertex = static_cast<std::uint32_t>(scene.vertices.size());
  const auto first_normal = static_cast<std::uint32_t>(scene.normals.size());
  const auto take = [&](auto primitive) {
    if (instance.material != kNone) primitive.material = instance.material;
    primitive.number += number;
    return primitive;
  };
  scene.texturing.append(part.texturing, scene.triangles.size(), mesh.triangles.size());
  scene.vertices.insert(scene.vertices.end(), part.vertices.begin(), part.vertices.end());
  scene.normals.insert(scene.normals.end(), part.normals.begin(), part.normals.end());
  for (Triangle t : part.triangles) {
    for (std::uint32_t& v : t.vertex) v += first_vertex;
    for (std::uint32_t& n : t.normal) n = n == kNone ? kNone : n + first_normal;
    scene.triangles.push_back(take(t));
  }
  primitives::for_each_shape([&](auto kind) {
    for (const auto& shape : decltype(kind)::of(part)) decltype(kind)::of(scene).push_back(take(shape));
  });
}

Copies flatten_instances(Scene& scene) {
  Copies copies;
  const auto instances = std::exchange(scene.instances, {});
  const auto meshes = std::exchange(scene.meshes, {});
  Amount all(scene);
  for (const Instance& instance : instances) all.add(Amount(*meshes[instance.mesh]));
  check_capacity(all, scene);
  scene.vertices.reserve(all.vertices);
  scene.normals.reserve(all.normals);
  for (const Instance& instance : instances) {
    copies.first.push_back(scene.primitive_count());
    copies.is_mirrored.push_back(glm::determinant(instance.linear) < 0);
    try {
      add_copy(*meshes[instance.mesh], instance, scene);
    } catch (const std::domain_error& e) {
      throw input_error(scene.name, 0, std::string("an instance: ") + e.what(),
                        "leave it out, or ask about the scene in floats");
    }
  }
  if (copies.size() > 0) copies.first.push_back(scene.primitive_count());
  return copies;
}

Instancing::Instancing(Instances how) : outer_(std::exchange(wanted, how)) {}
Instancing::~Instancing() {
  wanted = outer_;
}
Instances Instancing::how() {
  return wanted;
}

}  // namespace kdray::scene
