#include "apps/view/pick.h"

#include <algorithm>
#include <cmath>

#include "api/committed.h"
#include "base/local_space.h"
#include "engine/query/queries.h"
#include "layout/kinds.h"

namespace kdray::view {

namespace {

dvec3 vector_of(const Vec3& v) {
  return {v[0], v[1], v[2]};
}
Vec3 values_of(const dvec3& v) {
  return {v.x, v.y, v.z};
}

// The primitive of that number, of whichever kind. The scene's own come first, and then those of meshes with
// instances, whose numbers are of the mesh.
template <class Array>
bool find(const Array& primitives, std::uint64_t n_own, const char* kind, std::uint32_t number,
          Picked& picked) {
  for (std::size_t i = 0; i < std::min<std::uint64_t>(n_own, primitives.size()); ++i)
    if (primitives.data()[i].number == number) {
      picked.kind = kind;
      picked.material = primitives.data()[i].material;
      return true;
    }
  return false;
}

}  // namespace

EyeRay eye_ray(const Camera& camera, double aspect, double x, double y) {
  constexpr double kDegree = 3.141592653589793 / 180;
  const dvec3 from = vector_of(camera.from), up_wanted = vector_of(camera.up);
  const dvec3 forward = safe_normalize(vector_of(camera.at) - from);
  const dvec3 right =
      glm::normalize(glm::cross(forward, up_wanted * scale_to_one(largest_component(up_wanted))));
  const dvec3 up = glm::cross(right, forward);
  const bool parallel = camera.ortho_width > 0;
  const double half_height = parallel ? camera.ortho_width / 2 / aspect : std::tan(camera.fov * kDegree / 2);
  const dvec3 across = right * ((2 * x - 1) * half_height * aspect) + up * ((1 - 2 * y) * half_height);
  if (parallel) return {values_of(from + across), values_of(forward)};
  return {camera.from, values_of(glm::normalize(forward + across))};
}

Picker::Picker(const PreparedScene& scene, std::vector<GeometryName> geometries, const DeviceOptions& device)
    : scene_(scene),
      geometries_(std::move(geometries)),
      asked_(std::make_unique<api::Committed>(scene, device)) {}
Picker::~Picker() = default;

std::optional<Picked> Picker::pick(const EyeRay& ray) {
  std::uint32_t number = kNoPrimitive, instance = kNoInstance;
  Picked picked;
  const Rays rays{Points(ray.origin.data(), 1), Points(ray.direction.data(), 1)};
  const HitsOut out{.t = {&picked.distance, 1},
                    .primitive = {&number, 1},
                    .normal = {picked.normal.data(), 1},
                    .point = {picked.point.data(), 1},
                    .instance = {&instance, 1}};
  query::closest(asked_->query_context(), rays, out, {});
  if (number == kNoPrimitive) return std::nullopt;
  instance == kNoInstance ? name(number, picked) : name_instance(number, instance, picked);
  return picked;
}

// Primitives of meshes have no numbers of their own in the scene, so only an instance's own material is
// known.
void Picker::name_instance(std::uint32_t number, std::uint32_t instance, Picked& picked) const {
  picked.kind = "instance";
  picked.primitive = number;
  picked.instance = instance;
  if (const auto& names = scene_.settings().names) picked.part = names->of_instance(instance);
  for (const layout::Instance& placed : scene_.prepared().flat.instances)
    if (placed.number == instance && placed.material != KDRAY_MESH_MATERIAL)
      picked.material = placed.material;
}

void Picker::name(std::uint32_t number, Picked& picked) const {
  const flatten::FlatScene& flat = scene_.prepared().flat;
  const prepare::Counts& own = scene_.prepared().counts;
  bool found = find(flat.triangles, own.triangles, "triangle", number, picked);
#define KDRAY_FIND(NAME, name, names, Struct) \
  found = found || find(flat.names, own.names, #name, number, picked);
  KDRAY_SHAPES(KDRAY_FIND)
#undef KDRAY_FIND
  picked.primitive = number;
  if (const auto& names = scene_.settings().names) picked.part = names->of_primitive(number);
  for (const GeometryName& geometry : geometries_) {
    picked.geometry = geometry.id;
    picked.geometry_name = geometry.name;
    if (picked.primitive < geometry.primitives) break;
    picked.primitive -= geometry.primitives;
  }
}

}  // namespace kdray::view
