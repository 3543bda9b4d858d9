// What    A scene that asks everything of a wavefront: glass and mirrors in a mirror box, every kind of
//         primitive, more lights than a round serves; and renders of it by any schedule, to be held against
//         each other.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "accel/flatten/features.h"
#include "accel/flatten/flatten.h"
#include "accel/flatten/frame.h"
#include "accel/flatten/wide.h"
#include "accel/kdtree/build.h"
#include "engine/pdprt/render.h"
#include "scene/model/geometry.h"

namespace kdray::test {

// Glass and mirror spheres and cones and a smooth sail in a mirror box: every ray spawns two, to the depth
// limit.
inline scene::Scene hall_of_mirrors(int n_lights = 11) {
  scene::Scene s;
  s.vertices = {{-3, -3, -3}, {3, -3, -3}, {3, 3, -3}, {-3, 3, -3},
                {-3, -3, 3},  {3, -3, 3},  {3, 3, 3},  {-3, 3, 3}};
  const std::uint32_t quads[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                     {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
  std::uint32_t number = 0;
  for (const auto& q : quads)
    for (const auto& corner : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
      scene::Triangle t;
      t.vertex = corner;
      t.number = number++;
      s.triangles.push_back(t);
    }
  s.materials = {{.ambient = vec3(0.05f, 0.1f, 0.02f), .diffuse = vec3(0.3f), .reflect = vec3(0.5f)},
                 {.specular = vec3(0.5f),
                  .reflect = vec3(0.4f),
                  .transmit = vec3(0.5f, 0.4f, 0.3f),
                  .shine = 20,
                  .index = 1.5f}};
  for (int i = 0; i < 5; ++i) {
    scene::Sphere sphere{
        .center = {i - 2.0, 0.3 * i - 0.5, 0.4 * i - 1}, .radius = 0.6, .material = 1, .number = number++};
    s.spheres.push_back(sphere);
  }
  s.cones.push_back({.base = {-2, 1.5, -2.5},
                     .apex = {-1.8, 1.7, 1.2},
                     .base_radius = 0.7,
                     .apex_radius = 0.1,
                     .material = 1,
                     .number = number++});
  s.vertices.insert(s.vertices.end(), {{1, 1.6, -1}, {2.4, 1.4, -0.8}, {1.7, 1.8, 1.3}});
  s.normals = {{-0.48f, -0.8f, -0.36f}, {0.48f, -0.8f, -0.36f}, {0, -0.8f, 0.6f}};
  scene::Triangle sail;
  sail.vertex = {8, 9, 10};
  sail.normal = {0, 1, 2};
  sail.material = 1;
  sail.number = number++;
  s.triangles.push_back(sail);
  for (int i = 0; i < n_lights; ++i)
    s.lights.push_back({.position = {0.5 * i - 2.5, 2.5 - 0.1 * i, 1.0 - i * 0.3},
                        .color = vec3(0.05f * static_cast<float>(i + 1))});
  s.camera = scene::Camera{.from = {0, -2.5, 2}, .at = {0, 1, 0}, .up = {0, 0, 1}, .vertical_fov = 1.2};
  return s;
}

// The scene on a device.
struct Hall {
  scene::Scene scene = hall_of_mirrors();
  scene::Geometry geometry = scene::make_geometry(scene);
  kdtree::Tree tree = kdtree::build(geometry);
  flatten::FlatScene flat = flatten::flatten(scene, geometry, tree);
  flatten::WideForm wide = flatten::make_wide(tree, flat, flatten::choose_block(tree));
  layout::Features features = flatten::features_of(scene, geometry);

  static RenderOptions options() {
    RenderOptions o;
    o.width = 61;
    o.height = 43;
    o.depth = 7;
    o.min_weight = 0;
    return o;
  }

  pdprt::Task task(const RenderOptions& o = options()) const {
    const RenderOptions full = flatten::resolved(o, {});
    pdprt::Task task;
    task.frame = flatten::make_frame(scene, geometry, full);
    task.features = features | flatten::features_of_samples(full.samples);
    return task;
  }

  pdprt::Result render(const device::Context& context, const wavefront::Schedule& schedule,
                       const RenderOptions& o = options()) const {
    return render(std::vector{context}, schedule, task(o));
  }

  pdprt::Result render(const std::vector<device::Context>& contexts, const wavefront::Schedule& schedule,
                       const pdprt::Task& task) const {
    std::vector<std::unique_ptr<wavefront::SceneBuffers>> buffers;
    std::vector<std::unique_ptr<wavefront::Programs>> programs;
    std::vector<pdprt::Device> devices;
    for (const device::Context& context : contexts) {
      buffers.push_back(std::make_unique<wavefront::SceneBuffers>(context, flat, wide));
      programs.push_back(std::make_unique<wavefront::Programs>(context, tree.max_depth, wide));
      devices.push_back({&context, buffers.back().get(), programs.back().get(), schedule});
    }
    return pdprt::render(devices, task);
  }
};

inline void expect_same(const pdprt::Result& result, const pdprt::Result& reference) {
  EXPECT_EQ(result.rgb, reference.rgb);
  const wavefront::Counters &a = result.counters, &b = reference.counters;
  EXPECT_EQ(a.primary, b.primary);
  EXPECT_EQ(a.primary_hit, b.primary_hit);
  EXPECT_EQ(a.reflected, b.reflected);
  EXPECT_EQ(a.refracted, b.refracted);
  EXPECT_EQ(a.shadow, b.shadow);
  EXPECT_EQ(a.skipped_behind, b.skipped_behind);
  EXPECT_EQ(a.skipped_unlit, b.skipped_unlit);
  EXPECT_EQ(a.skipped_weight, b.skipped_weight);
  EXPECT_EQ(a.skipped_depth, b.skipped_depth);
  EXPECT_EQ(a.pool_overflow, 0u);
}

}  // namespace kdray::test
