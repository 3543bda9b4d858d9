// The scene's part of kdray.h: what it is made of.
#include <algorithm>
#include <initializer_list>
#include <utility>

#include "api/c/boundary.h"

namespace kdray::capi {

std::string& last_error() {
  thread_local std::string message;
  return message;
}

void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, what);
}

namespace {

GeometryOptions options_of(const kdray_geometry_options* given) {
  const kdray_geometry_options o = grown(given, "options");
  GeometryOptions options;
  if (o.name != nullptr) options.name = o.name;
  if (o.mask != 0) options.mask = o.mask;
  options.material = o.material;
  options.prototype = o.prototype != 0;
  return options;
}

InstanceOptions options_of(const kdray_instance_options* given) {
  const kdray_instance_options o = grown(given, "options");
  InstanceOptions options;
  if (o.name != nullptr) options.name = o.name;
  if (o.mask != 0) options.mask = o.mask;
  options.materials = view_of<Words>(o.materials, "materials");
  return options;
}

std::string text_or_none(const char* text) {
  return text ? text : "";
}

LoadOptions options_of(const kdray_load_options* given) {
  const kdray_load_options o = grown(given, "options");
  constexpr Instances kInstances[] = {Instances::automatic, Instances::flat, Instances::kept};
  if (o.instances < KDRAY_INSTANCES_AUTOMATIC || o.instances > KDRAY_INSTANCES_KEPT)
    refuse("options: there is no such choice of instances");
  LoadOptions options{.animation = text_or_none(o.animation),
                      .texture_bytes = o.texture_bytes,
                      .instances = kInstances[o.instances],
                      .asset_root = text_or_none(o.asset_root)};
  if (o.smooth_degrees != 0) options.smooth_degrees = o.smooth_degrees;
  if (o.time) options.time = *o.time;
  return options;
}

void put(std::uint32_t* id, std::uint32_t value) {
  if (id != nullptr) *id = value;
}

kdray_status add(kdray_scene* scene, const char* kind, std::initializer_list<kdray_field> fields,
                 const kdray_geometry_options* options, std::uint32_t* id) {
  return kdray_add_shapes(scene, kind, fields.begin(), fields.size(), options, id);
}

constexpr Light::Kind kLightKinds[] = {Light::Kind::point,     Light::Kind::directional, Light::Kind::spot,
                                       Light::Kind::rectangle, Light::Kind::sphere,      Light::Kind::disc};

// What is left 0 has C++'s default, where that is another; kdray.h says so beside each.
Light light_of(const kdray_light& l) {
  const Light usual;
  if (l.kind < KDRAY_POINT_LIGHT || l.kind > KDRAY_DISC_LIGHT) refuse("light: there is no such kind");
  return {.kind = kLightKinds[l.kind],
          .position = vector(l.position),
          .direction = vector_or(l.direction, usual.direction),
          .color = color(l.color) == Color{0, 0, 0} ? usual.color : color(l.color),
          .attenuation = vector_or(l.attenuation, usual.attenuation),
          .range = l.range == 0 ? usual.range : l.range,
          .inner_degrees = l.inner_degrees,
          .outer_degrees = l.outer_degrees == 0 ? usual.outer_degrees : l.outer_degrees,
          .across = vector(l.across),
          .down = vector(l.down),
          .normal = vector_or(l.normal, usual.normal),
          .radius = l.radius};
}

// They are numbered from 1 here, since what is left 0 is none.
PictureId picture_of(std::uint32_t number) {
  return number == 0 ? kNoPicture : number - 1;
}

float factor_of(float given) {
  return given == 0 ? 1.0f : given == KDRAY_FACTOR_0 ? 0.0f : given;
}

AlphaMode alpha_of(std::int32_t mode) {
  constexpr AlphaMode kModes[] = {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend};
  if (mode < KDRAY_ALPHA_OPAQUE || mode > KDRAY_ALPHA_BLEND)
    refuse("material: there is no such mode of alpha");
  return kModes[mode];
}

Color color_at(const float* rgb, const char* name) {
  needed(rgb, name);
  return {rgb[0], rgb[1], rgb[2]};
}

}  // namespace

Camera camera_of(const kdray_camera* given) {
  const kdray_camera c = grown(given, "camera");
  const Camera usual;
  return {.from = vector(c.from),
          .at = vector(c.at),
          .up = vector_or(c.up, usual.up),
          .fov = c.fov == 0 ? usual.fov : c.fov,
          .ortho_width = c.ortho_width,
          .hither = c.hither,
          .aperture = c.aperture,
          .focus = c.focus};
}

}  // namespace kdray::capi

using namespace kdray;
using namespace kdray::capi;

const char* kdray_last_error(void) {
  return last_error().c_str();
}
uint32_t kdray_version(void) {
  return KDRAY_VERSION_NUMBER;
}

void kdray_set_texture_cache(uint64_t bytes) {
  set_texture_cache(bytes);
}

kdray_status kdray_scene_new(kdray_scene** scene) {
  return guarded([&] {
    needed(scene, "scene");
    *scene = new kdray_scene;
  });
}
kdray_status kdray_scene_load(const char* file, const kdray_load_options* options, kdray_scene** scene) {
  return guarded([&] {
    needed(scene, "scene");
    *scene = new kdray_scene{Scene::load(needed(file, "file"), options_of(options)), {}};
  });
}
void kdray_scene_free(kdray_scene* scene) {
  delete scene;
}

kdray_status kdray_add_mesh(kdray_scene* scene, kdray_in vertices, kdray_in triangles, kdray_in normals,
                            const kdray_geometry_options* options, uint32_t* id) {
  return guarded([&] {
    const Mesh mesh{view_of<Points>(vertices, "vertices"), view_of<Triples>(triangles, "triangles"),
                    view_of<Points>(normals, "normals"),
                    view_of<Pairs>(grown(options, "options").texcoords, "texcoords")};
    put(id, needed(scene, "scene")->scene.add_mesh(mesh, options_of(options)));
  });
}
kdray_status kdray_add_shapes(kdray_scene* scene, const char* kind, const kdray_field* fields,
                              size_t n_fields, const kdray_geometry_options* options, uint32_t* id) {
  return guarded([&] {
    Shapes shapes{needed(kind, "kind"), {}};
    const ShapeKind& known = shape_kind(shapes.kind);
    if (n_fields > 0) needed(fields, "fields");
    for (std::size_t i = 0; i < n_fields; ++i) {
      const char* const name = needed(fields[i].name, "a field's name");
      const bool is_vector = std::ranges::any_of(
          known.fields, [&](const ShapeKind::Field& f) { return f.name == name && f.is_vector; });
      if (is_vector)
        shapes.fields.push_back({name, view_of<Points>(fields[i].rows, name)});
      else
        shapes.fields.push_back({name, view_of<Values>(fields[i].rows, name)});
    }
    put(id, needed(scene, "scene")->scene.add_shapes(shapes, options_of(options)));
  });
}
kdray_status kdray_add_spheres(kdray_scene* scene, kdray_in centers, kdray_in radii,
                               const kdray_geometry_options* options, uint32_t* id) {
  return add(scene, "spheres", {{"centers", centers}, {"radii", radii}}, options, id);
}
kdray_status kdray_add_cones(kdray_scene* scene, kdray_in bases, kdray_in base_radii, kdray_in apexes,
                             kdray_in apex_radii, const kdray_geometry_options* options, uint32_t* id) {
  const kdray_field fields[] = {
      {"bases", bases}, {"base_radii", base_radii}, {"apexes", apexes}, {"apex_radii", apex_radii}};
  const bool pointed = apex_radii.count == 0;
  return kdray_add_shapes(scene, "cones", fields, pointed ? 3 : 4, options, id);
}
kdray_status kdray_add_discs(kdray_scene* scene, kdray_in centers, kdray_in normals, kdray_in radii,
                             const kdray_geometry_options* options, uint32_t* id) {
  return add(scene, "discs", {{"centers", centers}, {"normals", normals}, {"radii", radii}}, options, id);
}
kdray_status kdray_add_tori(kdray_scene* scene, kdray_in centers, kdray_in axes, kdray_in major_radii,
                            kdray_in minor_radii, const kdray_geometry_options* options, uint32_t* id) {
  return add(
      scene, "tori",
      {{"centers", centers}, {"axes", axes}, {"major_radii", major_radii}, {"minor_radii", minor_radii}},
      options, id);
}

kdray_status kdray_add_instances(kdray_scene* scene, uint32_t prototype, kdray_in transforms,
                                 const kdray_instance_options* options, uint32_t* id) {
  return guarded([&] {
    const Transforms rows = view_of<Transforms>(transforms, "transforms");
    put(id, needed(scene, "scene")->scene.add_instances(prototype, rows, options_of(options)));
  });
}
kdray_status kdray_update_transforms(kdray_scene* scene, uint32_t instances, kdray_in transforms) {
  return guarded([&] {
    needed(scene, "scene")->scene.update_transforms(instances, view_of<Transforms>(transforms, "transforms"));
  });
}

kdray_status kdray_name_of(const kdray_scene* scene, uint32_t geometry, uint32_t primitive, uint32_t instance,
                           char* name, size_t size) {
  return guarded([&] {
    const std::string found = needed(scene, "scene")->scene.name_of(geometry, primitive, instance);
    if (size == 0) refuse("name: there are no bytes for it");
    needed(name, "name")[found.copy(name, size - 1)] = 0;
  });
}

kdray_status kdray_update_vertices(kdray_scene* scene, uint32_t mesh, kdray_in vertices, kdray_in normals) {
  return guarded([&] {
    needed(scene, "scene")
        ->scene.update_vertices(mesh, view_of<Points>(vertices, "vertices"),
                                view_of<Points>(normals, "normals"));
  });
}
kdray_status kdray_remove(kdray_scene* scene, uint32_t geometry) {
  return guarded([&] { needed(scene, "scene")->scene.remove(geometry); });
}
kdray_status kdray_enable(kdray_scene* scene, uint32_t geometry, int enabled) {
  return guarded([&] { needed(scene, "scene")->scene.enable(geometry, enabled != 0); });
}
kdray_status kdray_set_mask(kdray_scene* scene, uint32_t geometry, uint32_t mask) {
  return guarded([&] { needed(scene, "scene")->scene.set_mask(geometry, mask); });
}

kdray_status kdray_add_material(kdray_scene* scene, const kdray_material* material, uint32_t* id) {
  return guarded([&] {
    const kdray_material m = grown(needed(material, "material"), "material");
    put(id, needed(scene, "scene")
                ->scene.add_material({.emission = color(m.emission),
                                      .ambient = color(m.ambient),
                                      .diffuse = color(m.diffuse),
                                      .specular = color(m.specular),
                                      .reflect = color(m.reflect),
                                      .transmit = color(m.transmit),
                                      .shine = m.shine,
                                      .index = m.index == 0 ? 1.0f : m.index,
                                      .picture = picture_of(m.picture),
                                      .normal_picture = picture_of(m.normal_picture),
                                      .emission_picture = picture_of(m.emission_picture),
                                      .alpha = alpha_of(m.alpha),
                                      .metal_picture = picture_of(m.metal_picture),
                                      .metallic = factor_of(m.metallic),
                                      .roughness = factor_of(m.roughness),
                                      .occlusion_picture = picture_of(m.occlusion_picture),
                                      .occlusion = factor_of(m.occlusion)}));
  });
}

kdray_status kdray_add_picture(kdray_scene* scene, const kdray_pixels* pixels, uint32_t* id) {
  return guarded([&] {
    const kdray_pixels p = grown(needed(pixels, "pixels"), "pixels");
    put(id, 1 + needed(scene, "scene")
                    ->scene.add_picture(Pixels{.data = p.data,
                                               .width = p.width,
                                               .height = p.height,
                                               .channels = p.channels,
                                               .row_bytes = p.row_bytes}));
  });
}
kdray_status kdray_add_picture_file(kdray_scene* scene, const char* file, uint32_t* id) {
  return guarded([&] {
    put(id, 1 + needed(scene, "scene")->scene.add_picture(std::filesystem::path(needed(file, "file"))));
  });
}

kdray_status kdray_add_light(kdray_scene* scene, const kdray_light* light) {
  return guarded(
      [&] { needed(scene, "scene")->scene.add_light(light_of(grown(needed(light, "light"), "light"))); });
}
kdray_status kdray_set_camera(kdray_scene* scene, const kdray_camera* camera) {
  return guarded([&] { needed(scene, "scene")->scene.set_camera(camera_of(needed(camera, "camera"))); });
}
kdray_status kdray_set_background(kdray_scene* scene, const float rgb[3]) {
  return guarded([&] { needed(scene, "scene")->scene.set_background(color_at(rgb, "rgb")); });
}
kdray_status kdray_set_gradient(kdray_scene* scene, const double* heights, const float* rgb, size_t count,
                                const double up[3]) {
  return guarded([&] {
    Gradient gradient;
    for (size_t i = 0; i < count; ++i)
      gradient.stops.push_back({needed(heights, "heights")[i], color_at(needed(rgb, "rgb") + 3 * i, "rgb")});
    if (up != nullptr) gradient.up = {up[0], up[1], up[2]};
    needed(scene, "scene")->scene.set_background(gradient);
  });
}
kdray_status kdray_set_environment(kdray_scene* scene, const char* file, const double up[3],
                                   double turn_degrees, double strength) {
  return guarded([&] {
    Environment environment{.file = needed(file, "file"), .turn_degrees = turn_degrees, .strength = strength};
    if (up != nullptr) environment.up = {up[0], up[1], up[2]};
    needed(scene, "scene")->scene.set_background(environment);
  });
}
kdray_status kdray_set_ambient(kdray_scene* scene, const float rgb[3]) {
  return guarded([&] { needed(scene, "scene")->scene.set_ambient(color_at(rgb, "rgb")); });
}

kdray_status kdray_commit(kdray_scene* scene, const kdray_commit_options* given) {
  return guarded([&] {
    const kdray_commit_options o = grown(given, "options");
    constexpr BuildQuality kQualities[] = {BuildQuality::balanced, BuildQuality::fast, BuildQuality::best};
    if (o.quality < 0 || o.quality > 2) refuse("options: the quality may be 0, 1 or 2");
    constexpr VertexPrecision kGeometries[] = {VertexPrecision::float32, VertexPrecision::float64,
                                               VertexPrecision::automatic};
    if (o.geometry < 0 || o.geometry > 2) refuse("options: the geometry may be 0, 1 or 2");
    CommitOptions options;
    options.tree.quality = kQualities[o.quality];
    options.tree.geometry = kGeometries[o.geometry];
    if (o.device != nullptr) options.device.device = o.device;
    options.device.programs = default_program_folder();
    if (o.refit_growth != 0) options.refit_growth = o.refit_growth;
    kdray_scene* const s = needed(scene, "scene");
    s->report = s->scene.commit(options);
  });
}
kdray_status kdray_last_commit(const kdray_scene* scene, int* refitted, double* growth) {
  return guarded([&] {
    const CommitReport& last = needed(scene, "scene")->report;
    if (refitted != nullptr) *refitted = last.refitted ? 1 : 0;
    if (growth != nullptr) *growth = last.growth;
  });
}
kdray_status kdray_keep_programs(void) {
  return guarded([] {
    DeviceOptions device;
    device.programs = default_program_folder();
    keep_programs(device);
  });
}
