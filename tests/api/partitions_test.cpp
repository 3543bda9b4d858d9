// Frames in ODPRT over ranks that hold shares of the scene, no rank all of it: whatever the number of ranks
// and queues, and in whatever order messages come, rank 0 has the picture and the rays of one process;
// checkpoints go from one to the other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <optional>

#include "api/hooks.h"
#include "cluster/partition/ply_files.h"
#include "cluster/partition/scene_partition.h"
#include "cluster/transport/simulated.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "scene/import/load.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/folder.h"
#include "support/rank_threads.h"

namespace kdray::test {
namespace {

using partition::ScenePartition;
using MakePartition = std::function<ScenePartition(transport::Together&)>;

struct Shot {
  std::vector<Picture> pictures;
  nlohmann::json statistics;
};

struct Way {
  int ranks = 1, queues = 1;
  std::vector<RenderOptions> frames;
  std::optional<transport::Link> link = {};
};

constexpr int kWidth = 54, kHeight = 41;

RenderOptions options() {
  RenderOptions o = exact_options(kWidth, kHeight);
  o.mode = Mode::odprt;
  o.tile_width = o.tile_height = 8;
  return o;
}

Shot frames_of(Renderer& renderer, const std::vector<RenderOptions>& frames) {
  Shot shot;
  for (const RenderOptions& o : frames) shot.pictures.push_back(renderer.render(o));
  shot.statistics = statistics_of(renderer);
  return shot;
}

class Holdings : public EachDevice {
 protected:
  DeviceOptions device(int queues) const {
    DeviceOptions o;
    o.device = GetParam();
    o.queues = queues;
    return device_of(o);
  }

  Shot alone(const scene::Scene& scene, std::vector<RenderOptions> frames = {options()}) const {
    for (RenderOptions& o : frames) o.mode = Mode::pdprt;
    Renderer renderer(Scene(scene::Scene(scene)), {}, device(1));
    return frames_of(renderer, frames);
  }

  // What rank 0 has.
  Shot together(const MakePartition& make_partition, const Way& way) const {
    auto transports = transport::in_process(way.ranks);
    if (way.link)
      for (auto& transport : transports)
        transport = transport::delayed(std::move(transport), *way.link,
                                       static_cast<std::uint64_t>(transport->rank() + 1));
    const DeviceOptions device = this->device(way.queues);
    std::vector<Shot> shots(transports.size());
    run_ranks(std::move(transports), [&](transport::Ranks& ranks, const std::function<void()>& ready) {
      // The thread's, for as long as it has a renderer.
      const std::shared_ptr<transport::Ranks> shared(std::shared_ptr<void>(), &ranks);
      const auto all = std::make_shared<transport::Together>(ranks);
      ready();
      ScenePartition own = make_partition(*all);
      const auto whole =
          std::make_shared<const api::WholeScene>(api::WholeScene{own.core, own.primitives, all});
      Renderer renderer = api::make_renderer(PreparedScene(std::move(own.prepared)), device,
                                             {.ranks = shared, .whole = whole});
      shots[static_cast<std::size_t>(ranks.rank())] = frames_of(renderer, way.frames);
    });
    return std::move(shots.front());
  }

  static void expect_same(const Shot& one, const Shot& divided) {
    ASSERT_EQ(divided.pictures.size(), one.pictures.size());
    for (std::size_t i = 0; i < one.pictures.size(); ++i)
      EXPECT_TRUE(same_bits(divided.pictures[i].rgb, one.pictures[i].rgb)) << "frame " << i;
    for (const char* const kind : {"primary", "primary_hit", "shadow", "reflected", "refracted", "total"})
      EXPECT_EQ(divided.statistics["rays"][kind], one.statistics["rays"][kind]) << kind;
  }

  void expect_same_by(const scene::Scene& scene, const MakePartition& make_partition,
                      const std::vector<std::pair<int, int>>& ways) const {
    const Shot one = alone(scene);
    for (const auto& [ranks, queues] : ways) {
      SCOPED_TRACE(fmt::format("{} ranks of {} queues", ranks, queues));
      const Shot shot = together(make_partition, {ranks, queues, {options()}});
      expect_same(one, shot);
      EXPECT_EQ(shot.statistics["mode"]["parts"], ranks * queues);
      EXPECT_EQ(shot.statistics["mode"]["ranks"]["scene"], "shares");
      EXPECT_EQ(shot.statistics["mode"]["ranks"]["peak_bytes"].size(), static_cast<std::size_t>(ranks));
    }
  }
};

MakePartition of(const scene::Scene& scene) {
  return [&scene](transport::Together& all) { return partition::partition_scene(scene, {}, all); };
}
MakePartition of(const std::filesystem::path& file) {
  return [file](transport::Together& all) { return partition::partition_scene(file, {}, {}, all).value(); };
}

const std::vector<std::pair<int, int>> kWays = {{1, 1}, {2, 1}, {3, 1}, {4, 1}, {7, 1},
                                                {1, 2}, {2, 2}, {3, 2}, {4, 2}, {7, 2}};

// Between them all kinds, materials, lights and pictures; each scene in two ways.
TEST_P(Holdings, OfScenesThatEveryRankHas) {
  std::vector<NamedScene> scenes = small_scenes();
  for (const NamedScene& s : std::initializer_list<NamedScene>{{"textured", textured},
                                                               {"mapped", mapped},
                                                               {"soft_light", soft_light},
                                                               {"under_a_sky", under_a_sky}})
    scenes.push_back(s);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    SCOPED_TRACE(scenes[i].name);
    const scene::Scene scene = scenes[i].make();
    expect_same_by(scene, of(scene), {kWays[1 + i % 4], kWays[5 + i % 5]});
  }
}

TEST_P(Holdings, OfAFileReadInShares) {
  const Folder folder;
  const auto file = folder.put("ball.ply", ball_ply(24, {.normals = true, .colors = true}, true));
  expect_same_by(scene::load(file), of(file), kWays);
}

// Some ranks have nothing, or all of them.
TEST_P(Holdings, OfFewPrimitives) {
  const Folder folder;
  PlyWriter one(3, 1, {});
  one.vertex(0, 0, 0), one.vertex(1, 0, 0), one.vertex(0, 1, 0);
  one.face(0, 1, 2);
  const std::vector<std::pair<int, int>> ways = {{1, 1}, {3, 1}, {2, 2}, {7, 1}};
  const auto triangle = folder.put("one.ply", one.text());
  expect_same_by(scene::load(triangle), of(triangle), ways);
  const auto none = folder.put("none.ply", PlyWriter(0, 0, {}).text());
  expect_same_by(scene::load(none), of(none), ways);
  // Three spheres and nothing else, one of which is glass.
  scene::Scene three;
  three.materials = {{.diffuse = vec3(0.7f), .reflect = vec3(0.3f)},
                     {.reflect = vec3(0.2f), .transmit = vec3(0.8f), .index = 1.4f}};
  for (std::uint32_t i = 0; i < 3; ++i)
    three.spheres.push_back({.center = {1.5 * i - 1.5, 0, 0}, .radius = 0.8, .material = i % 2, .number = i});
  three.lights.push_back({.position = {0, 5, 5}, .color = vec3(1)});
  three.camera = scene::Camera{.from = {4, 1, 5}, .at = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 0.7};
  expect_same_by(three, of(three), ways);
}

TEST_P(Holdings, SequencesAndAdaptiveSampling) {
  const scene::Scene scene = smooth_meshes();
  std::vector<RenderOptions> frames(3, options());
  frames[1].width = 33;
  frames[2].adaptive_target = 0.02;
  const Shot one = alone(scene, frames);
  for (const auto& [ranks, queues] : {std::pair(3, 1), std::pair(2, 2)})
    expect_same(one, together(of(scene), {ranks, queues, frames}));
}

// KDRAY_NETWORKS: how many.
TEST_P(Holdings, AnyNetwork) {
  const char* const wanted = std::getenv("KDRAY_NETWORKS");
  const int n = wanted ? std::atoi(wanted) : 6;
  const scene::Scene scene = glass_and_mirror_balls();
  const Shot one = alone(scene);
  constexpr int kBuffers[] = {0, 33, 5};
  for (int i = 0; i < n; ++i) {
    Way way{2 + i % 6, 1 + i / 2 % 2, {options()}};
    way.frames.front().ray_buffer = kBuffers[i % 3];
    way.link = {.latency = i % 3 == 0 ? 1e-3 : 2e-5, .jitter = 10, .bandwidth = i % 2 == 0 ? 1e9 : 2e7};
    SCOPED_TRACE(fmt::format("network {}: {} ranks of {} queues", i, way.ranks, way.queues));
    expect_same(one, together(of(scene), way));
    if (HasFailure()) return;
  }
}

// Begun in shares and gone on with by one process, and the other way round.
TEST_P(Holdings, CheckpointsAreTheSame) {
  const Folder folder;
  const scene::Scene scene = every_kind();
  const Shot one = alone(scene);
  const auto kept = [&](const std::string& name) {
    RenderOptions o = options();
    o.ledger = LedgerOptions{.folder = folder / name, .resume = true};
    return std::vector{o};
  };
  const auto number = [](const Shot& shot, const char* of) { return shot.statistics["ledger"][of]; };
  const Shot begun = together(of(scene), {3, 1, kept("shares")});
  EXPECT_EQ(number(begun, "rendered"), number(begun, "pieces"));
  const Shot more = together(of(scene), {4, 1, kept("shares")}), by_one = alone(scene, kept("shares"));
  const Shot begun_by_one = alone(scene, kept("one")), shares = together(of(scene), {2, 2, kept("one")});
  for (const Shot* const shot : {&more, &by_one, &shares}) EXPECT_EQ(number(*shot, "rendered"), 0);
  for (const Shot* const shot : {&begun, &more, &by_one, &begun_by_one, &shares})
    EXPECT_TRUE(same_bits(shot->pictures[0].rgb, one.pictures[0].rgb));
  const scene::Scene other = every_light();
  EXPECT_TRUE(fails([&] { together(of(other), {2, 1, kept("shares")}); }, "scene", ErrorCode::input));
}

TEST_P(Holdings, RanksWithOtherScenesAreRefused) {
  const scene::Scene balls = glass_and_mirror_balls(), meshes = smooth_meshes();
  const MakePartition of_each = [&](transport::Together& all) {
    return partition::partition_scene(all.leads() ? balls : meshes, {}, all);
  };
  EXPECT_TRUE(fails([&] { together(of_each, {3, 1, {options()}}); }, "another scene", ErrorCode::input));
}

// As rays have it that come from another part: t_max is the t of what lies there, whose number is no place.
TEST_P(Holdings, RaysThatEndAtAHit) {
  scene::Scene scene;
  scene.vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, {-9, -9, -1}, {9, -9, -1}, {0, 9, -1}};
  for (const std::uint32_t i : {0u, 1u}) {
    scene::Triangle t;
    t.vertex = {3 * i, 3 * i + 1, 3 * i + 2};
    t.number = 7 + 100 * i;
    scene.triangles.push_back(t);
  }
  scene.materials = {{}};
  Renderer renderer(Scene(scene::Scene(scene)), {.binary_form = false}, device(1));
  std::vector<Ray> rays;
  for (int i = 0; i < 64; ++i)
    rays.push_back({{0.01f * static_cast<float>(i), 0.3f, 2.5f}, 0, {0, 0, -1}, 100});
  for (const Traversal walk : {Traversal::wide, Traversal::packet, Traversal::batch}) {
    std::vector<Ray> ending = rays;
    const std::vector<Hit> hits = renderer.trace(rays, false, 1, walk);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(hits[i].primitive, 7);
      ending[i].t_max = hits[i].t;
    }
    for (const Hit& hit : renderer.trace(ending, false, 1, walk)) EXPECT_EQ(hit.primitive, -1);
  }
}

KDRAY_FOR_EACH_DEVICE(Holdings);

}  // namespace
}  // namespace kdray::test
