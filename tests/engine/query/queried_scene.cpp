#include "engine/query/queried_scene.h"

#include <fmt/format.h>

#include <map>
#include <tuple>
#include <utility>

#include "device/opencl/context.h"

namespace kdray::test {

namespace {

const device::Context& context() {
  static const device::Context opened(usable_devices().front(), 1);
  return opened;
}

// What a program's options depend on (wavefront/programs.cpp), and more.
std::shared_ptr<wavefront::Programs> programs_of(const prepare::Prepared& p) {
  static std::map<std::tuple<int, int, int, std::size_t>, std::shared_ptr<wavefront::Programs>> made;
  auto& programs = made[{p.tree_depth / 8, p.wide.stack_size / 32, p.wide.block, p.wide.bytes() >> 22}];
  if (!programs) programs = std::make_shared<wavefront::Programs>(context(), p.tree_depth, p.wide);
  return programs;
}

prepare::Prepared prepared_in(const scene::Scene& scene, Space space, Blocks blocks) {
  prepare::Prepared p = prepared_of(scene, blocks);
  if (space == Space::own) p.geometry.space = {};
  return p;
}

}  // namespace

prepare::Prepared prepared_of(const scene::Scene& scene, Blocks blocks,
                              const std::optional<LocalSpace>& kept) {
  const std::size_t as_many = blocks == Blocks::of_eight ? 1000000 : scene.primitive_count();
  const kdtree::BuildConfig config = prepare::config_of(TreeOptions{}, as_many);
  return prepare::prepare(scene, scene::make_geometry(scene, kept), config, false);
}

QueriedScene::QueriedScene(const scene::Scene& scene, Space space, Blocks blocks)
    : QueriedScene(prepared_in(scene, space, blocks)) {}

QueriedScene::QueriedScene(prepare::Prepared&& prepared)
    : prepared_(std::move(prepared)),
      buffers_(context(), prepared_.flat, prepared_.wide),
      programs_(programs_of(prepared_)) {}

query::Target QueriedScene::target(Traversal walk) {
  query::Target target{context(), buffers_, *programs_, prepared_,
                       std::min<std::size_t>(16, context().max_work_group())};
  target.traversal = walk;
  return target;
}

float QueriedScene::reach() const {
  const Box& b = prepared_.geometry.bounds;
  const vec3 m = glm::max(glm::abs(b.lo), glm::abs(b.hi));
  return std::max({m.x, m.y, m.z});
}

Ray ray_from(const vec3& o, const vec3& d, float t_min, float t_max) {
  return {{o.x, o.y, o.z}, t_min, {d.x, d.y, d.z}, t_max};
}

std::string in_words(const Ray& r) {
  return fmt::format("origin {:a} {:a} {:a} direction {:a} {:a} {:a} t {:a} to {:a}", r.origin[0],
                     r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2], r.t_min,
                     r.t_max);
}

}  // namespace kdray::test
