#include "scene/model/check_scene.h"

#include <string>

#include "base/error.h"
#include "base/local_space.h"

namespace kdray::scene {

namespace {

bool is_finite_vec3(const vec3& v) {
  return is_finite(dvec3(v));
}

bool at_least_zero(const vec3& v) {
  return is_finite_vec3(v) && v.x >= 0 && v.y >= 0 && v.z >= 0;
}

class Checker {
 public:
  explicit Checker(const Scene& scene) : Checker(scene, scene.materials.size()) {}
  Checker(const Scene& scene, std::size_t n_materials) : scene_(scene), n_materials_(n_materials) {}

  void run() const {
    check_counts();
    check_values();
    check_triangles();
    primitives::for_each_shape([this](auto kind) { check_shapes(kind); });
    check_textures();
    check_instances();
  }

  void run_mesh() const {
    check_counts();
    check_values();
    check_triangles();
    primitives::for_each_shape([this](auto kind) { check_shapes(kind); });
    check_corners();
  }

 private:
  void require(bool good, const std::string& what) const {
    if (!good) throw input_error(scene_.name, 0, what, "correct the file");
  }
  void require_internal(bool good, const std::string& what) const {
    if (!good) throw Error(ErrorCode::internal, scene_.name + ": the reader of this format left " + what);
  }
  void require_none(const char* fault, const std::string& where) const {
    if (fault) require(false, where + ": " + fault);
  }

  void check_counts() const {
    primitives::for_each_kind([this](auto kind) {
      if (decltype(kind)::of(scene_).size() >= kMaxPrimitivesPerKind)
        throw input_error(scene_.name, 0, "2^28 primitives of one kind or more", "split the scene");
    });
    require_internal(scene_.primitive_count() == 0 || n_materials_ > 0, "primitives without a material");
  }

  void check_values() const {
    for (std::size_t i = 0; i < scene_.vertices.size(); ++i) {
      if (!is_finite(scene_.vertices[i])) require(false, "vertex " + std::to_string(i) + " is not finite");
    }
    for (std::size_t i = 0; i < scene_.normals.size(); ++i) {
      if (!is_finite_vec3(scene_.normals[i]))
        require(false, "normal " + std::to_string(i) + " is not finite");
    }
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      require_none(fault_of(scene_.materials[i]), "material " + std::to_string(i));
    }
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
      require_none(fault_of(scene_.lights[i]), "light " + std::to_string(i));
    }
    if (scene_.camera) require_none(fault_of(*scene_.camera), "camera");
    require(at_least_zero(scene_.background), "the background colour is not finite, or below 0");
    require_none(fault_of(scene_.sky), "background");
    require(at_least_zero(scene_.ambient), "the ambient light is not finite, or below 0");
  }

  void check_triangles() const {
    const std::size_t n_vertices = scene_.vertices.size();
    const std::size_t n_normals = scene_.normals.size();
    for (const Triangle& t : scene_.triangles) {
      bool good = t.material < n_materials_;
      for (const std::uint32_t v : t.vertex) good = good && v < n_vertices;
      const bool smooth = t.normal[0] != kNone;
      for (const std::uint32_t n : t.normal) good = good && (smooth ? n < n_normals : n == kNone);
      if (!good) require_internal(false, "a triangle with an index that is out of range");
    }
  }

  template <class Kind>
  void check_shapes(Kind) const {
    for (const auto& shape : Kind::of(scene_)) {
      if (shape.material >= n_materials_)
        require_internal(false, std::string("a ") + Kind::kName + " without a material");
      if (const char* const fault = fault_of(shape))
        require(false, "primitive " + std::to_string(shape.number) + ": " + fault);
    }
  }

  // Kernels use these indices without a check.
  void check_textures() const {
    const Texturing& texturing = scene_.texturing;
    for (const Material& m : scene_.materials)
      require_internal(m.maps == kNone || m.maps < texturing.material_maps.size(),
                       "a material without its maps");
    for (const MaterialMaps& c : texturing.material_maps) check_maps(c);
    for (const Texture& t : texturing.textures) {
      bool good =
          t.picture < texturing.pictures.size() && t.set < 2 && t.minify <= Minify::linear_mipmap_linear;
      for (const float f : t.across) good = good && std::isfinite(f);
      for (const float f : t.down) good = good && std::isfinite(f);
      require_internal(good, "a texture without its picture");
    }
    for (const auto& p : texturing.pictures)
      require_internal(
          p && p->width > 0 && p->height > 0 && p->texels.size() == std::size_t{4} * p->width * p->height,
          "a picture without its texels");
    check_corners();
  }

  void check_corners() const {
    const Texturing& texturing = scene_.texturing;
    const std::size_t n = scene_.triangles.size();
    require_internal(texturing.colors.size() <= n && texturing.texcoords[0].size() <= n &&
                         texturing.texcoords[1].size() <= n && texturing.tangents.size() <= n,
                     "colours, texture coordinates or tangents of more triangles than there are");
  }

  void check_instances() const {
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      if (instance.mesh >= scene_.meshes.size() ||
          (instance.material != kNone && instance.material >= scene_.materials.size()))
        require_internal(false, "an instance without its mesh");
      if (const char* const fault = fault_of(instance))
        require(false, "instance " + std::to_string(i) + ": " + fault);
    }
    // Meshes are checked as scenes with this one's materials.
    for (const auto& mesh : scene_.meshes) {
      require_internal(mesh->instances.empty(), "instances in a mesh");
      Checker(*mesh, scene_.materials.size()).run_mesh();
    }
  }

  void check_maps(const MaterialMaps& c) const {
    for (const std::uint32_t map :
         {c.base, c.normal_map, c.emission_map, c.occlusion_map, c.highlight_map, c.metal_map})
      require_internal(map == kNone || map < scene_.texturing.textures.size(),
                       "material maps without their texture");
    bool good = c.alpha >= 0 && c.alpha <= 1 && std::isfinite(c.cutoff) && std::isfinite(c.normal_scale);
    for (const float share :
         {c.occlusion, c.metal.metallic, c.metal.roughness, c.metal.transmission, c.metal.mirrored})
      good = good && share >= 0 && share <= 1;
    for (const vec3* term : {&c.emission, &c.ambient, &c.diffuse, &c.specular, &c.reflect, &c.transmit,
                             &c.emissive, &c.metal.base})
      good = good && at_least_zero(*term);
    require_internal(good, "material maps with a term that is not finite, or below 0");
  }

  const Scene& scene_;
  std::size_t n_materials_;
};

}  // namespace

void check_scene(const Scene& scene) {
  Checker(scene).run();
}

const char* fault_of(const Camera& c) {
  if (!is_finite(c.from) || !is_finite(c.at) || !is_finite(c.up)) return "a coordinate is not finite";
  const dvec3 forward = c.at - c.from;
  if (!is_finite(forward)) return "'from' and 'at' are farther apart than double precision goes";
  if (forward == dvec3(0)) return "'from' and 'at' are the same point";
  if (c.up == dvec3(0)) return "'up' has no length";
  // Nearer to parallel than this, the sideways direction would be made of rounding errors.
  if (glm::length(glm::cross(safe_normalize(forward), safe_normalize(c.up))) < 1e-9)
    return "'up' is parallel to the view direction";
  if (!std::isfinite(c.ortho_width) || c.ortho_width < 0) return "the orthographic width is below 0";
  if (!(c.vertical_fov > 0 && c.vertical_fov < 3.14159265))
    return "the angle of view is not between 0 and 180 degrees";
  if (!std::isfinite(c.hither) || c.hither < 0) return "'hither' is below 0";
  if (!std::isfinite(c.aperture) || c.aperture < 0) return "the aperture is below 0";
  if (!std::isfinite(c.focus) || c.focus < 0) return "the focus is below 0";
  if (!std::isfinite(c.aperture / (c.focus > 0 ? c.focus : safe_length(forward))))
    return "the aperture is out of all proportion to the focus";
  return nullptr;
}

const char* fault_of(const Material& m) {
  for (const vec3* v : {&m.emission, &m.ambient, &m.diffuse, &m.specular, &m.reflect, &m.transmit}) {
    if (!at_least_zero(*v)) return "a colour is not finite, or below 0";
  }
  if (!std::isfinite(m.shine) || m.shine < 0) return "the shine is not finite, or below 0";
  if (!std::isfinite(m.index) || m.index <= 0) return "the index of refraction is not above 0";
  return nullptr;
}

namespace {

const char* fault_of_area(const Light& l) {
  if (l.kind == LightKind::sphere)
    return std::isfinite(l.radius) && l.radius > 0 ? nullptr : "the light's radius is not above 0";
  if (!has_area(l.kind)) return nullptr;
  if (!is_finite(l.across) || !is_finite(l.down)) return "an edge of the light is not finite";
  if (l.across == dvec3(0) || l.down == dvec3(0))
    return l.kind == LightKind::disc ? "the light's radius is not above 0"
                                     : "an edge of the light has no length";
  return nullptr;
}

}  // namespace

const char* fault_of(const Light& l) {
  if (!at_least_zero(l.color)) return "the colour is not finite, or below 0";
  if (!is_finite(l.position)) return "the position is not finite";
  const bool has_direction = l.kind == LightKind::directional || l.kind == LightKind::spot;
  if (has_direction && !(std::abs(glm::length(l.direction) - 1) < 1e-6))
    return "the direction has no unit length";
  const dvec3 a = l.attenuation;
  if (!is_finite(a) || glm::any(glm::lessThan(a, dvec3(0))) || !(a.x + a.y + a.z > 0))
    return "the attenuation is not finite, below 0, or all 0";
  if (!(l.range > 0)) return "the range is not above 0";
  if (const char* const fault = fault_of_area(l)) return fault;
  if (!(l.cos_outer >= -1 && l.cos_outer <= l.cos_inner && l.cos_inner <= 1)) {
    return "the spot's inner angle is wider than its outer one";
  }
  return nullptr;
}

}  // namespace kdray::scene
