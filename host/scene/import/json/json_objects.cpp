#include "scene/import/json/json_objects.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "scene/import/files.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/model/instances.h"
#include "scene/model/normals.h"
#include "scene/model/polygon.h"

namespace kdray::scene {

namespace {

// Reads [x, y, z], degrees about the axes, x first; or {"axis": [x, y, z], "angle": degrees}.
dmat4 read_rotation(const JsonNode& node) {
  if (node.is_object()) {
    node.expect_keys(json_keys::kTurn);
    return rotation(node["axis"].direction(), glm::radians(node["angle"].number()));
  }
  if (!node.is_array()) throw node.expected("[x, y, z] in degrees or {\"axis\": ..., \"angle\": ...}");
  const dvec3 turn = glm::radians(node.vector());
  return rotation({0, 0, 1}, turn.z) * rotation({0, 1, 0}, turn.y) * rotation({1, 0, 0}, turn.x);
}

dvec3 read_scale(const JsonNode& node) {
  const dvec3 scale = node.is_array() ? node.vector() : dvec3(node.number());
  if (scale.x == 0 || scale.y == 0 || scale.z == 0) throw node.error("a scale of 0");
  return scale;
}

// Reads sixteen numbers row by row, as they are written on paper; the last row is 0 0 0 1.
dmat4 read_matrix(const JsonNode& node) {
  if (!node.is_array() || node.size() != 16) throw node.expected("16 numbers, row by row");
  const auto elements = node.elements();
  dmat4 m;
  for (int i = 0; i < 16; ++i) m[i % 4][i / 4] = elements[static_cast<std::size_t>(i)].number();
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
    throw node.error("the last row is not 0 0 0 1");
  const double volume = glm::determinant(dmat3(m));
  if (!std::isfinite(volume) || volume == 0) throw node.error("the matrix flattens the object");
  return m;
}

// Returns the transform of an object: scaled first, then turned, then moved.
std::optional<dmat4> read_transform(const JsonNode& object) {
  const auto translate = object.find("translate"), rotate = object.find("rotate"),
             scale = object.find("scale");
  const auto matrix = object.find("matrix");
  if (matrix) {
    if (translate || rotate || scale)
      throw matrix->error("a matrix beside translate, rotate or scale", "keep one kind");
    return read_matrix(*matrix);
  }
  if (!translate && !rotate && !scale) return std::nullopt;
  dmat4 m(1);
  if (translate) m = m * translation(translate->vector());
  if (rotate) m = m * read_rotation(*rotate);
  if (scale) m = m * scaling(read_scale(*scale));
  return m;
}

void place(const JsonNode& object, Scene& part) {
  const std::optional<dmat4> m = read_transform(object);
  if (!m) return;
  try {
    apply_transform(*m, part);
  } catch (const std::domain_error& e) {
    throw object.error(e.what());
  }
}

template <class Shape>
void read_field(const JsonNode& object, const primitives::Field<Shape, dvec3>& field, Shape& shape) {
  const JsonNode node = object[field.key];
  shape.*field.member = field.meaning == primitives::Meaning::direction ? node.direction() : node.vector();
}

template <class Shape>
void read_field(const JsonNode& object, const primitives::Field<Shape, double>& field, Shape& shape) {
  using primitives::Meaning;
  double& value = shape.*field.member;
  if (field.meaning == Meaning::at_least_zero_or_left_out) {
    if (const auto node = object.find(field.key)) value = node->number_from(0);
    return;
  }
  const JsonNode node = object[field.key];
  value = field.meaning == Meaning::above_zero ? node.number_above(0) : node.number_from(0);
}

// v goes downwards, as u goes to the right.
std::vector<std::array<float, 2>> read_texcoords(const JsonNode& node, std::size_t n_vertices) {
  std::vector<std::array<float, 2>> out;
  for (const JsonNode& pair : node.elements()) {
    const auto parts = pair.elements();
    if (parts.size() != 2) throw pair.expected("[u, v]");
    out.emplace_back();
    for (std::size_t c = 0; c < 2; ++c) {
      out.back()[c] = static_cast<float>(parts[c].number());
      if (!std::isfinite(out.back()[c])) throw parts[c].error("a value beyond 3.4e38");
    }
  }
  if (out.size() != n_vertices) throw node.error("not one pair for each vertex");
  return out;
}

// Returns the name of a material that an object names; empty of one that stands there.
std::string name_in(const JsonNode& material) {
  return material.is_string() ? material.string() : std::string();
}

Scene imported(const std::filesystem::path& path, const JsonNode& name, bool keeps_texcoords) {
  try {
    return import_scene(path, keeps_texcoords);
  } catch (const Error&) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (std::filesystem::status_known(status) && std::filesystem::exists(status)) throw;
    throw name.error("no file " + path.string());
  }
}

// Of a part of one material.
bool shows_pictures(const Scene& part) {
  return part.materials[0].maps != kNone;
}

// Returns the name of a part's material: the object's, or else what the part's own file calls it.
std::string name_of(const Scene& part, std::uint32_t material, const JsonNode& object) {
  if (const auto own = object.find("material")) return name_in(*own);
  return part.names ? std::string(part.names->of_material(material)) : std::string();
}

}  // namespace

JsonObjects::JsonObjects(Scene& scene, const NamedMaterials& named, JsonMaterials& unnamed,
                         std::filesystem::path folder)
    : scene_(scene),
      named_(named),
      unnamed_(unnamed),
      folder_(std::move(folder)),
      materials_(scene.materials) {}

void JsonObjects::read(const JsonNode& object) {
  const JsonNode type = object["type"];
  const std::string name = type.string();
  if (name == "mesh") return read_mesh(object);
  if (name == "triangles") return read_triangles(object);
  if (name == "box") return read_box(object);
  if (name == "cylinder") return read_cylinder(object);
  if (name == "plane") return read_plane(object);
  std::string known = "mesh, triangles, box, cylinder, plane";
  bool found = false;
  primitives::for_each_shape([&](auto kind) {
    using Kind = decltype(kind);
    known += std::string(", ") + Kind::kName;
    if (name != Kind::kName) return;
    found = true;
    read_shape(kind, object);
  });
  if (!found) throw type.expected("one of " + known);
}

// A part's materials have their maps in the part's own texturing.
void JsonObjects::wear(Scene& part, const Material& material) const {
  part.materials = {material};
  if (material.maps == kNone) return;
  part.texturing.material_maps = scene_.texturing.material_maps;
  part.texturing.textures = scene_.texturing.textures;
  part.texturing.pictures = scene_.texturing.pictures;
}

// Shapes have no texture coordinates.
void JsonObjects::wear_plain(Scene& part, const JsonNode& object) {
  wear(part, material_of(object));
  if (!shows_pictures(part) || std::exchange(warned_of_pictures_, true)) return;
  scene_.warnings.push_back(object.error("shapes show one place of their material's pictures").what());
}

Material JsonObjects::material_of(const JsonNode& object) const {
  const auto node = object.find("material");
  if (!node) return Material{.ambient = vec3(0.08f), .diffuse = vec3(0.72f)};
  if (!node->is_string()) return unnamed_.read(*node);
  const std::string name = node->string();
  const auto it = named_.find(name);
  if (it != named_.end()) return it->second;
  std::vector<std::string_view> names;
  for (const auto& entry : named_) names.push_back(entry.first);
  throw node->error("no material '" + name + "' in /materials", did_you_mean(name, names));
}

const Scene& JsonObjects::mesh(const JsonNode& file, bool keeps_texcoords) {
  const std::string name = file.string();
  const std::pair key(name, keeps_texcoords);
  const auto it = meshes_.find(key);
  if (it != meshes_.end()) return it->second;
  const std::filesystem::path path = folder_ / name;
  if (format_of(path) == ".json") throw file.error("a scene cannot include another .json scene");
  const Instancing copied(Instances::flat);  // a part has no instances of its own
  Scene& part = meshes_[key] = imported(path, file, keeps_texcoords);
  scene_.warnings.insert(scene_.warnings.end(), part.warnings.begin(), part.warnings.end());
  return part;
}

void JsonObjects::read_mesh(const JsonNode& object) {
  object.expect_keys(json_keys::kMesh);
  const bool has_own = object.find("material").has_value();
  const Material own = material_of(object);
  Scene part = mesh(object["file"], has_own && own.maps != kNone);
  if (const auto smooth = object.find("smooth")) smooth_normals(part, smooth->number_between(0, 180));
  place(object, part);
  if (has_own) {
    part.texturing = {.texcoords = std::move(part.texturing.texcoords)};
    wear(part, own);
    if (!shows_pictures(part)) part.texturing = {};
    if (shows_pictures(part) && part.texturing.texcoords[0].empty())
      scene_.warnings.push_back(
          object["file"].error("has no texture coordinates, so pictures show one place").what());
    for (Triangle& t : part.triangles) t.material = 0;
    primitives::for_each_shape([&](auto kind) {
      for (auto& shape : decltype(kind)::of(part)) shape.material = 0;
    });
  }
  if (object.find("instances")) return append_instances(std::move(part), object);
  append(part, object);
}

std::uint32_t JsonObjects::add_material(const Material& material, const std::string& name) {
  const std::uint32_t number = materials_.add(material);
  names_.name_material(number, name);
  return number;
}

// Returns the part with the scene's materials in place of its own.
Scene JsonObjects::adopted(Scene&& part, const JsonNode& object) {
  const std::vector<std::uint32_t> material_maps =
      scene_.texturing.append({.material_maps = part.texturing.material_maps,
                               .textures = part.texturing.textures,
                               .pictures = part.texturing.pictures},
                              scene_.triangles.size(), 0);
  std::vector<std::uint32_t> numbers;
  for (Material material : part.materials) {
    if (material.maps != kNone) material.maps = material_maps[material.maps];
    const auto number = static_cast<std::uint32_t>(numbers.size());
    numbers.push_back(add_material(material, name_of(part, number, object)));
  }
  for (Triangle& t : part.triangles) t.material = numbers[t.material];
  primitives::for_each_shape([&](auto kind) {
    for (auto& shape : decltype(kind)::of(part)) shape.material = numbers[shape.material];
  });
  Scene mesh;
  mesh.name = part.name;
  mesh.vertices = std::move(part.vertices);
  mesh.normals = std::move(part.normals);
  mesh.triangles = std::move(part.triangles);
  primitives::for_each_shape(
      [&](auto kind) { decltype(kind)::of(mesh) = std::move(decltype(kind)::of(part)); });
  mesh.texturing.colors = std::move(part.texturing.colors);
  mesh.texturing.texcoords = std::move(part.texturing.texcoords);
  return mesh;
}

void JsonObjects::append_instances(Scene&& part, const JsonNode& object) {
  const JsonNode list = object["instances"];
  if (!list.is_array()) throw list.expected("a list of placements");
  const auto mesh = std::make_shared<const Scene>(adopted(std::move(part), object));
  if (mesh->primitive_count() == 0) return;
  const bool kept = worth_keeping(mesh->primitive_count(), list.size());
  const auto number = static_cast<std::uint32_t>(scene_.meshes.size());
  if (kept && list.size() > 0) scene_.meshes.push_back(mesh);
  for (const JsonNode& placement : list.elements()) {
    placement.expect_keys(json_keys::kInstance);
    Instance instance = instance_of(read_transform(placement).value_or(dmat4(1)), number);
    if (const auto material = placement.find("material"))
      instance.material = add_material(material_of(placement), name_in(*material));
    if (const char* const fault = fault_of(instance)) throw placement.error(fault);
    if (kept) {
      scene_.instances.push_back(instance);
      continue;
    }
    try {
      add_copy(*mesh, instance, scene_);
    } catch (const std::domain_error& e) {
      throw placement.error(e.what());
    }
  }
  if (scene_.instances.size() >= kMaxInstances) throw list.error("2^27 instances or more", "leave some out");
  number_ = scene_.primitive_count();
}

void JsonObjects::read_triangles(const JsonNode& object) {
  object.expect_keys(json_keys::kTriangles);
  Scene part;
  wear(part, material_of(object));
  part.vertices = object["vertices"].vectors();
  const auto normals = object.find("normals");
  if (normals) {
    const auto given = normals->vectors();
    if (given.size() != part.vertices.size()) throw normals->error("not one normal for each vertex");
    for (const dvec3& n : given) {
      const double length = glm::length(n);
      if (!(length > 0) || !std::isfinite(length)) throw normals->error("a normal without a direction");
      part.normals.emplace_back(n / length);
    }
  }
  std::vector<std::array<float, 2>> texcoords;
  if (const auto uv = object.find("uv")) texcoords = read_texcoords(*uv, part.vertices.size());
  std::vector<dvec3> corners;
  for (const auto& face : object["faces"].faces(part.vertices.size())) {
    corners.clear();
    for (const std::uint32_t v : face) corners.push_back(part.vertices[v]);
    bool finished = true;
    const auto cut = triangulate(corners, &finished);
    if (!finished) scene_.warnings.push_back(object["faces"].error(polygon_warning(corners.size())).what());
    for (const auto& corner : cut) {
      Triangle t;
      for (std::size_t i = 0; i < 3; ++i) t.vertex[i] = face[corner[i]];
      if (normals) t.normal = t.vertex;
      t.number = static_cast<std::uint32_t>(part.triangles.size());
      part.triangles.push_back(t);
      if (texcoords.empty()) continue;
      layout::TexCoords at{};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t c = 0; c < 2; ++c) at.uv[i][c] = texcoords[t.vertex[i]][c];
      part.texturing.texcoords[0].push_back(at);
    }
  }
  place(object, part);
  append(part, object);
}

void JsonObjects::read_box(const JsonNode& object) {
  object.expect_keys(json_keys::kBox);
  Scene part;
  wear(part, material_of(object));
  const dvec3 lo = object["min"].vector(), hi = object["max"].vector();
  if (lo.x == hi.x || lo.y == hi.y || lo.z == hi.z) throw object.error("a box without a volume");
  add_box(part, lo, hi);
  if (shows_pictures(part)) add_box_texcoords(part);
  place(object, part);
  append(part, object);
}

void JsonObjects::read_cylinder(const JsonNode& object) {
  object.expect_keys(json_keys::kCylinder);
  Closed closed{object["base"].vector(), object["apex"].vector(), object["radius"].number_from(0), 0};
  const auto apex_radius = object.find("apex_radius");
  closed.apex_radius = apex_radius ? apex_radius->number_from(0) : closed.base_radius;
  if (const char* const fault = fault_of(closed)) throw object.error(fault);
  Scene part;
  wear_plain(part, object);
  add_closed(part, closed, scene_.discs.size(), unsettled_);
  append(part, object);
}

void JsonObjects::read_plane(const JsonNode& object) {
  object.expect_keys(json_keys::kPlane);
  Plane plane{object["point"].vector(), object["normal"].direction(), 0};
  if (const auto extent = object.find("extent")) plane.extent = extent->number_above(0);
  Scene part;
  wear_plain(part, object);
  add_plane(part, plane, scene_.discs.size(), unsettled_);
  append(part, object);
}

template <class Kind>
void JsonObjects::read_shape(Kind, const JsonNode& object) {
  using Shape = typename Kind::Source;
  object.expect_keys(json_keys::keys_of(Kind()));
  Shape shape{};
  std::apply([&](const auto&... fields) { (read_field(object, fields, shape), ...); },
             fields_of(static_cast<const Shape*>(nullptr)));
  if (const char* const fault = fault_of(shape)) throw object.error(fault);
  Scene part;
  wear_plain(part, object);
  Kind::of(part) = {shape};
  append(part, object);
}

void JsonObjects::append(const Scene& part, const JsonNode& object) {
  const std::uint64_t primitives = std::uint64_t{number_} + part.primitive_count();
  if (primitives >= kMaxPrimitivesPerKind || scene_.vertices.size() + part.vertices.size() >= kNone ||
      scene_.normals.size() + part.normals.size() >= kNone) {
    throw object.error("2^28 primitives or more in all", "leave some out");
  }
  const std::vector<std::uint32_t> material_maps =
      scene_.texturing.append(part.texturing, scene_.triangles.size(), part.triangles.size());
  std::vector<std::uint32_t> material(part.materials.size(), kNone);
  const auto take = [&](auto primitive) {  // numbers within the part become numbers within the scene
    std::uint32_t& m = material[primitive.material];
    if (m == kNone) {
      Material added = part.materials[primitive.material];
      if (added.maps != kNone) added.maps = material_maps[added.maps];
      m = add_material(added, name_of(part, primitive.material, object));
    }
    primitive.material = m;
    primitive.number += number_;
    return primitive;
  };
  const auto first_vertex = static_cast<std::uint32_t>(scene_.vertices.size());
  const auto first_normal = static_cast<std::uint32_t>(scene_.normals.size());
  scene_.vertices.insert(scene_.vertices.end(), part.vertices.begin(), part.vertices.end());
  scene_.normals.insert(scene_.normals.end(), part.normals.begin(), part.normals.end());
  for (Triangle t : part.triangles) {
    for (std::uint32_t& v : t.vertex) v += first_vertex;
    for (std::uint32_t& n : t.normal) n = n == kNone ? kNone : n + first_normal;
    scene_.triangles.push_back(take(t));
  }
  primitives::for_each_shape([&](auto kind) {
    for (const auto& shape : decltype(kind)::of(part)) decltype(kind)::of(scene_).push_back(take(shape));
  });
  number_ = static_cast<std::uint32_t>(primitives);
}

}  // namespace kdray::scene
