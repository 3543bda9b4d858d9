#include "pictures/scenes.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "conformance/all_kinds.h"
#include "oracle/build_scene.h"
#include "scene/model/instances.h"
#include "scene/model/tangents.h"
#include "support/scene_fields.h"

namespace kdray::test {
namespace {

using oracle::SceneBuilder;

scene::Material plastic(const vec3& color, float shine, float reflect = 0) {
  scene::Material m = oracle::matte(color);
  m.ambient = 0.1f * color;
  m.specular = vec3(0.5f);
  m.shine = shine;
  m.reflect = vec3(reflect);
  return m;
}

scene::Material tinted_glass(const vec3& tint, float index) {
  scene::Material m = oracle::glass(index, 0.8f * tint, vec3(0.1f));
  m.ambient = vec3(0.02f);
  m.specular = vec3(0.4f);
  m.shine = 40;
  return m;
}

SceneBuilder with_floor(double height = -1) {
  SceneBuilder b;
  b.quad({-20, height, 20}, {40, 0, 0}, {0, 0, -40}, plastic({0.6f, 0.55f, 0.4f}, 8, 0.1f));
  b.background({0.2f, 0.3f, 0.5f}).ambient(vec3(0.5f)).camera({0, 2.3, 7.1}, {0.05, 0.1, 0}, 0.62);
  return b.light({4, 8, 6}, vec3(0.6f)).light({-6, 5, 3}, {0.3f, 0.35f, 0.4f});
}

}  // namespace

void add_smooth_ball(scene::Scene& scene, const dvec3& center, double radius, int rows,
                     const scene::Material& m) {
  const int columns = 2 * rows;
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  const auto first_normal = static_cast<std::uint32_t>(scene.normals.size());
  scene.materials.push_back(m);
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double theta = std::numbers::pi * i / rows, phi = 2 * std::numbers::pi * j / columns;
      const dvec3 n{std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
      scene.vertices.push_back(center + radius * n);
      scene.normals.push_back(vec3(n));
    }
  }
  const auto add = [&](int i0, int j0, int i1, int j1, int i2, int j2) {
    scene::Triangle t;
    const int corner[3] = {i0 * columns + j0 % columns, i1 * columns + j1 % columns,
                           i2 * columns + j2 % columns};
    for (int k = 0; k < 3; ++k) t.vertex[k] = first + corner[k], t.normal[k] = first_normal + corner[k];
    t.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
    t.number = scene.primitive_count();
    scene.triangles.push_back(t);
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      // At a pole two of the four corners are one, and one of the two triangles is none.
      if (i + 1 < rows) add(i, j, i + 1, j, i + 1, j + 1);
      if (i > 0) add(i, j, i + 1, j + 1, i, j + 1);
    }
  }
}

scene::Scene glass_and_mirror_balls() {
  SceneBuilder b = with_floor();
  b.sphere({-1.3, 0, 0.4}, 1, tinted_glass({1, 0.9f, 0.9f}, 1.5f));
  b.sphere({-1.3, 0.1, 0.4}, 0.5, tinted_glass({0.9f, 1, 0.9f}, 1.2f));
  b.sphere({1.2, -0.2, 0.2}, 0.8, plastic({0.1f, 0.1f, 0.15f}, 60, 0.7f));
  b.sphere({0.2, -0.6, 1.6}, 0.4, plastic({0.8f, 0.2f, 0.1f}, 20));
  b.sphere({0.5, 0.9, -1.5}, 0.7, plastic({0.2f, 0.7f, 0.3f}, 5, 0.2f));
  return b.scene();
}

scene::Scene smooth_meshes() {
  scene::Scene s = with_floor().scene();
  add_smooth_ball(s, {-1.4, 0, 0}, 1, 6, plastic({0.7f, 0.3f, 0.2f}, 12));
  add_smooth_ball(s, {0.6, -0.2, 1.1}, 0.8, 8, tinted_glass({0.9f, 0.95f, 1}, 1.4f));
  add_smooth_ball(s, {1.6, 0.3, -0.8}, 1, 7, plastic({0.1f, 0.1f, 0.1f}, 50, 0.6f));
  return s;
}

scene::Scene cones_and_cylinders() {
  SceneBuilder b = with_floor();
  b.cone({-1.8, -1, 0}, 0.8, {-1.6, 1.2, 0.1}, 0, plastic({0.8f, 0.6f, 0.1f}, 15));
  b.cone({0, -1, 0.3}, 0.5, {0, 0.6, 0.3}, 0.9, plastic({0.2f, 0.4f, 0.8f}, 25, 0.2f));  // open at the top
  b.cone({0.4, -0.6, 2}, 0.3, {1.6, -0.5, 1.7}, 0.3, tinted_glass({0.9f, 1, 0.9f}, 1.3f));
  b.cone({1.8, -1, -0.4}, 0.6, {1.8, 0.9, -0.4}, 0.6, plastic({0.05f, 0.05f, 0.05f}, 80, 0.8f));
  b.cone({2.2, 1.6, -1}, 0, {-1.5, 1.5, -1.4}, 0.5, plastic({0.7f, 0.2f, 0.5f}, 10));
  return b.scene();
}

scene::Scene every_kind() {
  return mixed_scene(4, 23);
}

scene::Scene every_light() {
  SceneBuilder b;
  b.quad({-20, -1, 20}, {40, 0, 0}, {0, 0, -40}, plastic(vec3(0.7f), 6));
  b.sphere({-1, 0, 0}, 1, plastic({0.5f, 0.6f, 0.7f}, 30));
  b.cone({1.2, -1, 0.5}, 0.5, {1.2, 0.7, 0.5}, 0.2, plastic({0.7f, 0.6f, 0.3f}, 9));
  scene::Material lamp = oracle::glowing({0.9f, 0.8f, 0.4f});
  lamp.diffuse = vec3(0.2f);
  b.sphere({2.2, -0.6, -1}, 0.4, lamp);
  b.background({0.05f, 0.05f, 0.1f}).ambient({0.3f, 0.2f, 0.4f}).camera({0, 3, 7}, {0, -0.1, 0}, 0.6);

  scene::Light near;
  near.position = {-3, 1, 2};
  near.color = {2, 1.5f, 1};
  near.attenuation = {0.2f, 0.1f, 0.3f};
  scene::Light reach;
  reach.position = {3, 0.5, 1};
  reach.color = {0.2f, 0.4f, 0.6f};
  reach.range = 2.6;
  scene::Light sun;
  sun.kind = scene::LightKind::directional;
  sun.direction = glm::normalize(dvec3(-0.6, -1, -0.5));
  sun.color = {0.25f, 0.25f, 0.2f};
  sun.attenuation = {0, 0, 1};  // means nothing for a light without a place
  scene::Light spot;
  spot.kind = scene::LightKind::spot;
  spot.position = {0, 5, 3};
  spot.direction = glm::normalize(dvec3(0.1, -1, -0.4));
  spot.color = {0.6f, 0.2f, 0.2f};
  spot.cos_inner = 0.97f;
  spot.cos_outer = 0.9f;
  scene::Light sharp = spot;
  sharp.position = {-5, 4, -1};
  sharp.direction = glm::normalize(dvec3(1, -1, 0));
  sharp.color = {0.1f, 0.5f, 0.3f};
  sharp.cos_inner = sharp.cos_outer = 0.95f;
  return b.light(near).light(reach).light(sun).light(spot).light(sharp).scene();
}

scene::Scene flat_glass() {
  SceneBuilder b = with_floor();
  const scene::Material pane = tinted_glass({0.9f, 1, 1}, 1.5f), air = oracle::glass(1, {0.9f, 0.6f, 0.6f});
  b.quad({-2.4, -0.9, 0.5}, {1.5, 0, 0.3}, {0, 1.8, 0}, pane);  // slab, front
  b.quad({-2.4, -0.9, 0.2}, {0, 1.8, 0}, {1.5, 0, 0.3}, pane);  // slab, back
  b.quad({-0.4, -0.9, 1.5}, {1.3, 0, 0.1}, {0, 1.5, 0}, pane);  // prism: upright face, slope and floor
  b.quad({-0.4, 0.6, 1.5}, {1.3, 0, 0.1}, {0, -1.5, -1.5}, pane);
  b.quad({-0.4, -0.9, 1.5}, {0, 0, -1.5}, {1.3, 0, 0.1}, pane);
  b.quad({1.3, -0.8, 1}, {0.9, 0, -0.3}, {0, 1.2, 0}, air);
  b.quad({-3, -1, -3}, {6, 0, 0}, {0, 4, 0}, oracle::mirror({0.8f, 0.8f, 0.7f}));
  b.sphere({0.8, -0.4, -1}, 0.6, plastic({0.9f, 0.5f, 0.1f}, 12));
  return b.scene();
}

namespace {

// Colours and alpha from 0 to 255 without any order.
std::shared_ptr<const scene::Picture> noise(std::uint32_t width, std::uint32_t height, std::mt19937& random) {
  scene::Picture p = scene::blank_picture("noise", width, height);
  for (std::uint8_t& byte : p.texels) byte = static_cast<std::uint8_t>(random());
  return std::make_shared<const scene::Picture>(std::move(p));
}

// Takes what the base colour multiplies over into material maps.
void add_maps(scene::Scene& s, std::uint32_t material, scene::MaterialMaps c) {
  scene::Material& m = s.materials[material];
  c.ambient = m.ambient, c.diffuse = m.diffuse, c.reflect = m.reflect;
  m.ambient = m.diffuse = m.reflect = vec3(0);
  m.maps = s.texturing.add(c);
}

// Coordinates by where the corners are, two sets of them, and colours by chance.
void color_corners(scene::Scene& s, std::mt19937& random) {
  for (const scene::Triangle& t : s.triangles) {
    layout::CornerColors colors{};
    std::array<layout::TexCoords, 2> at{};
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3 p{s.vertices[t.vertex[k]]};
      at[0].uv[k][0] = 0.3f * p.x + 0.1f * p.z, at[0].uv[k][1] = 0.2f * p.y - 0.4f * p.z;
      at[1].uv[k][0] = 0.7f * p.y + 0.2f * p.x, at[1].uv[k][1] = 0.5f * p.x + 0.3f * p.z;
      for (auto& word : colors.c[k]) word = static_cast<layout::u32>(random());
    }
    s.texturing.colors.push_back(colors);
    for (std::size_t set = 0; set < 2; ++set) s.texturing.texcoords[set].push_back(at[set]);
  }
}

}  // namespace

// A floor by a repeated picture, a screen with holes before it, a veil, a mirror in colours, a ball whose
// shading is smooth, and one that is no triangle.
scene::Scene textured() {
  SceneBuilder b = with_floor();
  b.quad({-2.5, -0.9, 2}, {2.4, 0, 0.3}, {0.1, 2, 0}, plastic({0.8f, 0.9f, 0.7f}, 9));
  b.quad({0.2, -0.8, 2.5}, {1.7, 0, -0.3}, {0, 1.8, 0.1}, plastic(vec3(0.7f), 9));
  b.quad({-3, -1, -3}, {6, 0, 0}, {0, 4, 0}, oracle::mirror({0.8f, 0.8f, 0.7f}));
  b.sphere({1.9, -0.4, -0.5}, 0.6, plastic({0.9f, 0.5f, 0.1f}, 12));
  scene::Scene s = b.scene();
  add_smooth_ball(s, {-0.6, 0, -0.4}, 0.9, 9, plastic(vec3(0.9f), 20, 0.2f));
  std::mt19937 random(28);
  const std::uint32_t small = s.texturing.add(noise(7, 5, random)),
                      large = s.texturing.add(noise(32, 16, random));
  using scene::Alpha, scene::Texture, scene::Wrap;
  const std::uint32_t floor = s.texturing.add(Texture{.picture = large});
  const std::uint32_t screen = s.texturing.add(Texture{.picture = small,
                                                       .across = {2, 0.3f, 0.1f},
                                                       .down = {-0.2f, 2, 0},
                                                       .wrap_across = Wrap::mirror,
                                                       .wrap_down = Wrap::clamp,
                                                       .nearest = true});
  const std::uint32_t veil = s.texturing.add(Texture{.picture = large, .curved = false, .set = 1});
  for (const std::uint32_t half : {0u, 1u}) {  // a square's triangles have a material each
    add_maps(s, half, {.base = floor});
    add_maps(s, 2 + half, {.alpha = 0.9f, .cutoff = 0.4f, .base = screen, .mode = Alpha::mask});
    add_maps(s, 4 + half, {.alpha = 0.8f, .base = veil, .colored = 1, .mode = Alpha::blend});
    add_maps(s, 6 + half, {.colored = 1});
  }
  add_maps(s, 8, {.base = floor, .colored = 1});
  add_maps(s, 9, {.cutoff = 0.3f, .base = veil, .colored = 1, .mode = Alpha::mask});
  color_corners(s, random);
  return s;
}

// The same with mipmaps, and with more pictures: a floor of metal and glass here and there, bent normals on
// what is flat and what is smooth, a screen that shines, and a mirror whose reflection a picture scales.
scene::Scene mapped() {
  scene::Scene s = textured();
  std::mt19937 random(59);
  const std::uint32_t picture = s.texturing.add(noise(64, 64, random));
  using scene::Minify, scene::Texture;
  for (Texture& t : s.texturing.textures)
    t.minify = t.nearest ? Minify::nearest_mipmap_nearest : Minify::linear_mipmap_linear;
  const auto plain = [&](std::array<float, 3> across, std::array<float, 3> down, Minify minify) {
    return s.texturing.add(
        Texture{.picture = picture, .across = across, .down = down, .minify = minify, .curved = false});
  };
  const std::uint32_t fine = plain({3, 1, 0}, {0, 4, 0}, Minify::linear_mipmap_linear);
  const std::uint32_t coarse = plain({0.5f, 0, 0.2f}, {0.1f, 0.7f, 0}, Minify::linear_mipmap_nearest);
  const std::uint32_t sharp = plain({9, 0, 0}, {0, 9, 0}, Minify::nearest_mipmap_linear);
  const auto of = [&](std::uint32_t material) -> scene::MaterialMaps& {
    return s.texturing.material_maps[s.materials[material].maps];
  };
  for (const std::uint32_t half : {0u, 1u}) {
    of(half).metal_map = fine;
    of(half).metal = {.base = vec3(0.9f, 0.7f, 0.6f), .transmission = 0.4f, .mirrored = 0.1f};
    of(half).normal_map = coarse;
    of(half).normal_scale = 0.3f;
    of(2 + half).emission_map = sharp;
    of(2 + half).emissive = {0.2f, 0.4f, 0.1f};
    of(4 + half).occlusion_map = fine;
    of(4 + half).occlusion = 0.8f;
    of(6 + half).highlight_map = coarse;
  }
  of(9).normal_map = fine;
  of(9).normal_scale = 0.5f;
  of(9).tangents = 1;
  scene::smooth_tangents(s, 0, 0);
  return s;
}

// Over a floor that is a face, so that rays in the open see lights and background as well.
scene::Scene soft_light() {
  SceneBuilder b;
  b.quad({-20, -1, 20}, {40, 0, 0}, {0, 0, -40}, plastic({0.6f, 0.55f, 0.4f}, 8, 0.1f));
  b.sphere({-1.3, 0, 0.4}, 1, tinted_glass({1, 0.9f, 0.9f}, 1.5f));
  b.sphere({1.2, -0.2, 0.2}, 0.8, plastic({0.1f, 0.1f, 0.15f}, 60, 0.7f));
  b.cone({0, -1, 1.4}, 0.4, {0, 0.2, 1.4}, 0.1, plastic({0.8f, 0.2f, 0.1f}, 20));
  b.ambient(vec3(0.5f)).camera({0, 2.3, 7.1}, {0.05, 0.1, 0}, 0.62);
  scene::Light window, lamp, disc;
  window.kind = scene::LightKind::rectangle;
  window.position = {4, 6, 4}, window.across = {2, 0, -2}, window.down = {0.5, 2, 0.5};
  window.color = vec3(0.5f);
  lamp.kind = scene::LightKind::sphere;
  lamp.position = {-4, 3, 2}, lamp.radius = 0.8;
  lamp.color = {0.9f, 0.8f, 0.6f}, lamp.attenuation = {0.2, 0.1, 0.05};
  disc.kind = scene::LightKind::disc;
  disc.position = {0, 5, -3}, disc.across = {1, 0, 0}, disc.down = {0, 0, 1.5};
  disc.color = {0.3f, 0.35f, 0.4f}, disc.range = 9;
  b.light(window).light({6, 4, -2}, vec3(0.2f)).light(lamp).light(disc);
  return b
      .change([](scene::Scene& s) {
        s.sky = {.kind = scene::SkyKind::gradient,
                 .up = glm::normalize(dvec3(0.1, 1, 0.2)),
                 .stops = {{-0.5, {0.1f, 0.1f, 0.05f}}, {0, {0.6f, 0.6f, 0.7f}}, {0.8, {0.1f, 0.2f, 0.6f}}}};
        s.sky.brightest = scene::brightest_of(s.sky);
      })
      .scene();
}

scene::Scene under_a_sky() {
  scene::Scene s = glass_and_mirror_balls();
  scene::SkyPicture picture{"noise", 37, 19, {}};
  std::mt19937 random(5);
  for (int i = 0; i < 3 * 37 * 19; ++i) picture.rgb.push_back(static_cast<float>(random() % 1000) / 800.0f);
  picture.brightest = 1.25f;
  s.sky = {.kind = scene::SkyKind::picture,
           .up = glm::normalize(dvec3(-0.2, 1, 0.1)),
           .turn = 0.7,
           .picture = std::make_shared<const scene::SkyPicture>(std::move(picture))};
  s.sky.brightest = scene::brightest_of(s.sky);
  s.camera->aperture = 0.3;
  s.camera->focus = 6;
  return s;
}

std::uint32_t add_mesh(scene::Scene& scene, const scene::Scene& part) {
  const auto first = static_cast<std::uint32_t>(scene.materials.size());
  const std::vector<std::uint32_t> material_maps =
      scene.texturing.append({.material_maps = part.texturing.material_maps,
                              .textures = part.texturing.textures,
                              .pictures = part.texturing.pictures},
                             0, 0);
  for (scene::Material m : part.materials) {
    if (m.maps != scene::kNone) m.maps = material_maps[m.maps];
    scene.materials.push_back(m);
  }
  auto mesh = std::make_shared<scene::Scene>();
  mesh->vertices = part.vertices;
  mesh->normals = part.normals;
  mesh->triangles = part.triangles;
  primitives::for_each_shape([&](auto kind) { decltype(kind)::of(*mesh) = decltype(kind)::of(part); });
  mesh->texturing.colors = part.texturing.colors;
  mesh->texturing.texcoords = part.texturing.texcoords;
  for (auto& t : mesh->triangles) t.material += first;
  primitives::for_each_shape([&](auto kind) {
    for (auto& shape : decltype(kind)::of(*mesh)) shape.material += first;
  });
  scene.meshes.push_back(mesh);
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

void add_instance(scene::Scene& scene, std::uint32_t mesh, const dmat4& to_world, std::uint32_t material) {
  scene::Instance instance = scene::instance_of(to_world, mesh);
  instance.material = material;
  scene.instances.push_back(instance);
}

namespace {

// `picture` is textured() or mapped().
scene::Scene instanced_with(scene::Scene picture) {
  using scene::rotation, scene::scaling, scene::translation;
  scene::Scene s = with_floor().scene();
  scene::Scene ball;
  add_smooth_ball(ball, {3, 1, 0}, 1.5, 9, plastic({0.8f, 0.3f, 0.2f}, 20, 0.2f));
  scene::Scene glass_ball;
  add_smooth_ball(glass_ball, {0, 0, 0}, 1, 8, tinted_glass({0.6f, 0.9f, 0.7f}, 1.4f));
  SceneBuilder shapes;
  shapes.sphere({0, 0, 0}, 0.5, plastic({0.2f, 0.4f, 0.9f}, 15, 0.1f));
  shapes.cone({0, 0.4, 0}, 0.4, {0.2, 1.4, 0}, 0.1, plastic({0.9f, 0.8f, 0.2f}, 10));
  shapes.quad({-0.7, -0.5, 0.7}, {1.4, 0, 0}, {0, 0, -1.4}, oracle::mirror({0.7f, 0.7f, 0.8f}));
  // Without the floor, which are its first triangles.
  const auto drop_floor = [](auto& items) {
    if (items.size() > 2) items.erase(items.begin(), items.begin() + 2);
  };
  drop_floor(picture.triangles);
  drop_floor(picture.texturing.colors);
  for (auto& set : picture.texturing.texcoords) drop_floor(set);
  for (auto& t : picture.triangles) t.number -= 2;
  const std::uint32_t balls = add_mesh(s, ball), glass = add_mesh(s, glass_ball),
                      mixed = add_mesh(s, shapes.scene()), textured_part = add_mesh(s, picture);
  const auto own = static_cast<std::uint32_t>(s.materials.size());
  s.materials.push_back(plastic({0.3f, 0.7f, 0.3f}, 30, 0.3f));
  const dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  add_instance(s, balls, translation({-3.4, -0.6, 0}) * scaling(dvec3(0.6)));
  add_instance(s, balls, translation({1.8, 0.4, -3}) * rotation(z, 0.5) * scaling({-0.7, 0.4, 0.9}), own);
  add_instance(s, glass, translation({-0.3, -0.2, 1.6}) * rotation(x, 0.3) * scaling({0.8, 0.6, 0.7}));
  add_instance(s, balls, translation({-0.5, -0.3, 1.6}) * scaling(dvec3(0.1)));
  add_instance(s, mixed, translation({1.7, -0.3, 1.5}) * rotation(y, 1) * scaling(dvec3(1.2)));
  add_instance(s, mixed, translation({1.7, -0.3, 1.5}) * rotation(y, 1) * scaling(dvec3(1.2)), own);
  add_instance(s, mixed, translation({-2.5, 0.8, -1}) * rotation(z, 2) * scaling({0.9, -0.9, 0.9}));
  add_instance(s, textured_part, translation({0.2, 0.9, -2.5}) * rotation(y, 0.2) * scaling(dvec3(0.6)));
  for (int i = 0; i < 40; ++i)
    add_instance(s, i % 2 ? mixed : balls,
                 translation({-3 + 0.15 * i, -0.85, 2.6 + 0.02 * i}) * rotation(y, i) *
                     scaling(dvec3(0.004 * (1 + i % 5))));
  return s;
}

}  // namespace

scene::Scene instanced() {
  return instanced_with(textured());
}

scene::Scene instanced_maps() {
  using scene::rotation, scene::scaling, scene::translation;
  scene::Scene s = instanced_with(mapped());
  const auto textured_part = static_cast<std::uint32_t>(s.meshes.size() - 1);
  add_instance(s, textured_part,
               translation({-2.4, 0.3, -1}) * rotation({0, 1, 0}, -0.4) * scaling({-0.4, 0.4, 0.4}));
  return s;
}

scene::Scene moved(scene::Scene model, double scale, const dvec3& offset) {
  const auto place = [&](dvec3& p) { p = p * scale + offset; };
  scale_and_move(model, scale, offset);
  for (scene::Instance& i : model.instances) {
    i.linear *= scale;
    place(i.move);
  }
  for (scene::Light& l : model.lights) {
    place(l.position);
    l.range *= scale;
    l.attenuation.y /= scale;
    l.attenuation.z /= scale * scale;
  }
  place(model.camera->from), place(model.camera->at);
  model.camera->hither *= scale;
  return model;
}

const std::vector<NamedScene>& small_scenes() {
  static const std::vector<NamedScene> all = {
      {"glass_and_mirror_balls", glass_and_mirror_balls},
      {"smooth_meshes", smooth_meshes},
      {"cones_and_cylinders", cones_and_cylinders},
      {"every_kind", every_kind},
      {"every_light", every_light},
      {"flat_glass", flat_glass},
      {"scaled_down", [] { return moved(glass_and_mirror_balls(), 1e-4, dvec3(0)); }},
      {"scaled_up", [] { return moved(cones_and_cylinders(), 1e4, dvec3(0)); }},
      {"far_away",
       [] {
         return moved(smooth_meshes(), 1, {1e6, -1e6, 1e6});
       }},
      {"hither",
       [] {
         scene::Scene s = cones_and_cylinders();
         s.camera->hither = 6.9;  // cuts the nearer cones open
         return s;
       }},
  };
  return all;
}

}  // namespace kdray::test
