// Commits that refit a tree against commits that build one: whatever is asked, the answers are the same bits;
// and what is refitted and what isn't is told.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "accel/prepare/prepared.h"
#include "kdray/kdray.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/model/scene.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/meshes.h"

namespace kdray {
namespace {

using test::Cube;
using test::fails;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr unsigned kSeed = 11;

// ---- Meshes, and how they move

struct Arrays {
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles;

  std::vector<double> moved(const auto& to) const {
    std::vector<double> all;
    for (std::size_t i = 0; i < vertices.size(); i += 3) {
      const dvec3 v = to(dvec3(vertices[i], vertices[i + 1], vertices[i + 2]));
      all.insert(all.end(), {v.x, v.y, v.z});
    }
    return all;
  }
};

// A closed mesh of radius 1.
Arrays ball(std::uint32_t n) {
  const scene::Scene scene = generate::displaced_sphere(n);
  Arrays arrays;
  for (const dvec3& v : scene.vertices) arrays.vertices.insert(arrays.vertices.end(), {v.x, v.y, v.z});
  for (const scene::Triangle& t : scene.triangles)
    arrays.triangles.insert(arrays.triangles.end(), t.vertex.begin(), t.vertex.end());
  return arrays;
}

// Large triangles that pierce each other, and needles among them: cells cut all of them.
Arrays clutter(std::size_t n) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  Arrays arrays;
  for (std::size_t i = 0; i < n; ++i)
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      arrays.triangles.push_back(static_cast<std::uint32_t>(3 * i + corner));
      const bool thin = i % 3 == 0 && corner == 2;
      for (int k = 0; k < 3; ++k)
        arrays.vertices.push_back(thin ? arrays.vertices[arrays.vertices.size() - 3] + 1e-3 * anywhere(random)
                                       : anywhere(random));
    }
  return arrays;
}

dvec3 bent(const dvec3& v) {
  return v + 0.2 * dvec3(std::sin(2 * v.y), std::cos(3 * v.z), std::sin(v.x + v.y));
}
dvec3 turned(const dvec3& v) {
  return {v.y, -v.x, v.z};
}
dvec3 flattened(const dvec3& v) {
  return {v.x, 0.01 * v.y, v.z};
}
dvec3 away(const dvec3& v) {
  return v + dvec3(0.9, -0.7, 0.4);
}

struct NamedMove {
  const char* name;
  dvec3 (*to)(const dvec3&);
};
constexpr NamedMove kMoves[] = {{"bent", bent}, {"turned", turned}, {"flattened", flattened}, {"away", away}};

// ---- Everything that can be asked

template <class T>
void append(std::vector<std::uint8_t>& bytes, const std::vector<T>& values) {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(values.data());
  bytes.insert(bytes.end(), first, first + values.size() * sizeof(T));
}

struct Asking {
  std::vector<double> origins, directions, points;
  std::vector<float> float_origins, float_directions;

  // Rays of all sorts: some through vertices, some sixteen of a kind, some from far away.
  Asking(std::size_t n, const std::vector<double>& vertices) {
    std::mt19937 random(kSeed);
    std::normal_distribution<double> normal;
    dvec3 from{}, to{};
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t sort = i / 16 % 4;
      if (sort != 1 || i % 16 == 0) from = dvec3(normal(random), normal(random), normal(random));
      to = dvec3(normal(random), normal(random), normal(random)) * (sort == 1 ? 0.1 : 1.0);
      if (sort == 2) {
        const std::size_t v = random() % (vertices.size() / 3);
        to = dvec3(vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]);
      }
      if (sort == 3) from *= 40.0;
      const dvec3 d = to - from;
      origins.insert(origins.end(), {from.x, from.y, from.z});
      directions.insert(directions.end(), {d.x, d.y, d.z});
      points.insert(points.end(), {to.x, to.y, to.z});
    }
    float_origins.assign(origins.begin(), origins.end());
    float_directions.assign(directions.begin(), directions.end());
  }

  std::size_t size() const { return origins.size() / 3; }

  std::vector<std::uint8_t> closest(const Scene& scene, const Rays& rays) const {
    std::vector<double> t(size()), u(size()), v(size());
    std::vector<std::uint32_t> geometry(size()), primitive(size());
    std::vector<std::array<double, 3>> normal(size()), point(size());
    scene.closest(rays, {t, geometry, primitive, u, v, normal, point});
    std::vector<std::uint8_t> bytes;
    append(bytes, t), append(bytes, u), append(bytes, v), append(bytes, geometry), append(bytes, primitive);
    append(bytes, normal), append(bytes, point);
    return bytes;
  }
  std::vector<std::uint8_t> rays(const Scene& scene, const Rays& rays) const {
    std::vector<std::uint8_t> bytes = closest(scene, rays), any(size());
    std::vector<std::uint32_t> count(size());
    scene.any(rays, any);
    scene.count(rays, count);
    const AllHits all = scene.all(rays);
    append(bytes, any), append(bytes, count), append(bytes, all.splits), append(bytes, all.t);
    append(bytes, all.geometry), append(bytes, all.primitive), append(bytes, all.u), append(bytes, all.v);
    return bytes;
  }
  std::vector<std::uint8_t> nearest(const Scene& scene) const {
    std::vector<double> distance(size()), u(size()), v(size()), far(size());
    std::vector<std::uint32_t> geometry(size()), primitive(size());
    std::vector<std::array<double, 3>> point(size());
    std::vector<std::uint8_t> inside(size()), bytes;
    scene.closest_points(points, {distance, point, geometry, primitive, u, v});
    scene.inside(points, inside);
    scene.signed_distance(points, far);
    append(bytes, distance), append(bytes, point), append(bytes, geometry), append(bytes, primitive);
    append(bytes, u), append(bytes, v), append(bytes, inside), append(bytes, far);
    return bytes;
  }

  void expect_same(const Scene& a, const Scene& b) const {
    EXPECT_TRUE(rays(a, {origins, directions}) == rays(b, {origins, directions})) << "seed " << kSeed;
    EXPECT_TRUE(rays(a, {float_origins, float_directions}) == rays(b, {float_origins, float_directions}));
    EXPECT_TRUE(nearest(a) == nearest(b)) << "seed " << kSeed;
  }
};

class Refit : public test::EachDevice {
 protected:
  CommitOptions options(double growth) const {
    CommitOptions options;
    options.device.device = GetParam();
    options.refit_growth = growth;
    return options;
  }
  CommitOptions always() const { return options(kInfinity); }
  CommitOptions never() const { return options(0); }
  DeviceOptions device() const { return always().device; }

  // Hits by every walk of the wide form.
  void expect_same_walks(const Scene& a, const Scene& b, const Asking& asking) const {
    Renderer of_a(a.prepared(), device()), of_b(b.prepared(), device());
    std::vector<Ray> rays(asking.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        rays[i].origin[k] = asking.float_origins[3 * i + k];
        rays[i].direction[k] = asking.float_directions[3 * i + k];
      }
      rays[i].t_min = 0;
      rays[i].t_max = std::numeric_limits<float>::infinity();
    }
    const std::vector<Hit> expected = of_b.trace(rays, false, 1, Traversal::wide);
    for (const Traversal walk :
         {Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic}) {
      const std::vector<Hit> hits = of_a.trace(rays, false, 1, walk), any = of_a.trace(rays, true, 1, walk);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i].t, expected[i].t) << i;
        ASSERT_EQ(hits[i].primitive, expected[i].primitive) << i;
        ASSERT_EQ(hits[i].u, expected[i].u) << i;
        ASSERT_EQ(hits[i].v, expected[i].v) << i;
        ASSERT_EQ(any[i].t == 0, expected[i].primitive >= 0) << i;
      }
    }
  }
};
KDRAY_FOR_EACH_DEVICE(Refit);

// Two scenes that are told the same; one of them may refit.
struct Twins {
  Scene fitted, built;

  GeometryId add(const Arrays& mesh) {
    built.add_mesh({mesh.vertices, mesh.triangles});
    return fitted.add_mesh({mesh.vertices, mesh.triangles});
  }
  void both(const auto& change) { change(fitted), change(built); }
};

// Spheres, cones, discs and tori that do not move, about and among the meshes; the outermost keep the space.
void add_shapes(Scene& scene) {
  scene.add_spheres(
      {std::vector<double>{3, 3, 3, -3, -3, -3, 0.2, 0.1, 0}, std::vector<double>{0.5, 0.5, 0.9}});
  scene.add_cones({std::vector<double>{-1, 0, 0}, std::vector<double>{1, 0.3, 0}, std::vector<double>{0.4},
                   std::vector<double>{0.1}});
  scene.add_discs({std::vector<double>{0, 0, 1.2}, std::vector<double>{0, 0.1, 1}, std::vector<double>{0.7}});
  scene.add_tori({std::vector<double>{0, -0.2, 0}, std::vector<double>{0.2, 1, 0.1}, std::vector<double>{1.1},
                  std::vector<double>{0.15}});
}

TEST_P(Refit, AnswersAreThoseOfABuiltTree) {
  for (const bool with_shapes : {false, true})
    for (const Arrays& mesh : {ball(24), clutter(700)}) {
      Twins twins;
      const GeometryId id = twins.add(mesh);
      if (with_shapes) twins.both([](Scene& scene) { add_shapes(scene); });
      EXPECT_FALSE(twins.fitted.commit(always()).refitted);
      EXPECT_FALSE(twins.built.commit(never()).refitted);
      for (const NamedMove& move : kMoves) {
        SCOPED_TRACE(
            fmt::format("{} triangles {}, shapes {}", mesh.triangles.size() / 3, move.name, with_shapes));
        const std::vector<double> vertices = mesh.moved(move.to);
        twins.both([&](Scene& scene) { scene.update_vertices(id, vertices); });
        const CommitReport report = twins.fitted.commit(always());
        EXPECT_TRUE(report.refitted);
        EXPECT_GT(report.growth, 0);
        EXPECT_FALSE(twins.built.commit(never()).refitted);
        const Asking asking(4000, vertices);
        asking.expect_same(twins.fitted, twins.built);
        expect_same_walks(twins.fitted, twins.built, asking);
      }
      // Back where it was built, from far off: growth is of the tree as it was built.
      twins.both([&](Scene& scene) { scene.update_vertices(id, mesh.vertices); });
      EXPECT_NEAR(twins.fitted.commit(always()).growth, 1, 0.05);
    }
}

// A scene of its own that keeps its space answers as one that has never been anything else.
TEST_P(Refit, AnswersAreThoseOfAnotherSceneInTheSameSpace) {
  const Arrays mesh = ball(16);
  const std::vector<double> vertices = mesh.moved(bent);
  Scene moved, made;
  for (Scene* scene : {&moved, &made}) {
    add_shapes(*scene);
    scene->add_mesh({scene == &moved ? mesh.vertices : vertices, mesh.triangles});
    scene->commit(always());
  }
  moved.update_vertices(4, vertices);
  EXPECT_TRUE(moved.commit(always()).refitted);
  EXPECT_EQ(moved.prepared().prepared().geometry.space, made.prepared().prepared().geometry.space);
  Asking(3000, vertices).expect_same(moved, made);
}

TEST_P(Refit, PicturesAreThoseOfABuiltTree) {
  const Arrays mesh = ball(16);
  Twins twins;
  const GeometryId id = twins.add(mesh);
  twins.both([&](Scene& scene) {
    add_shapes(scene);
    scene.add_light({.position = {5, 6, 7}});
    scene.commit(&scene == &twins.fitted ? always() : never());
    scene.update_vertices(id, mesh.moved(bent));
    // These are no reason to build.
    scene.set_camera({.from = {2, 3, 6}, .at = {0, 0, 0}, .aperture = 0.1});
    scene.set_background(Gradient{.stops = {{-1, {1, 0, 0}}, {1, {0, 0, 1}}}});
    scene.add_light({.kind = Light::Kind::disc, .position = {-3, 4, 2}, .normal = {0, -2, 0}, .radius = 0.5});
    EXPECT_EQ(scene.commit(&scene == &twins.fitted ? always() : never()).refitted, &scene == &twins.fitted);
  });
  RenderOptions picture;
  picture.width = picture.height = 96;
  for (const Mode mode : {Mode::pdprt, Mode::odprt}) {
    picture.mode = mode;
    EXPECT_TRUE(twins.fitted.render(picture).rgb == twins.built.render(picture).rgb);
  }
}

// ---- What is refitted, and what isn't

TEST_P(Refit, BuildsWhatHasChangedOtherwise) {
  const Cube cube;
  Scene scene;
  const GeometryId a = scene.add_mesh({cube.vertices, cube.triangles});
  const GeometryId b = scene.add_mesh({cube.at(3, 0, 0), cube.triangles});
  scene.commit(always());
  const auto refits = [&] {
    scene.update_vertices(a, cube.at(0.125f, 0, 0));
    return scene.commit(always()).refitted;
  };
  EXPECT_TRUE(refits());
  scene.enable(b, false);
  EXPECT_FALSE(refits());
  EXPECT_TRUE(refits());
  scene.enable(b, true);
  EXPECT_FALSE(refits());
  const GeometryId c = scene.add_mesh({cube.at(0, 3, 0), cube.triangles});
  EXPECT_FALSE(refits());
  scene.remove(c);
  EXPECT_FALSE(refits());
  scene.add_material({.diffuse = {1, 0, 0}});
  scene.set_mask(b, 6);
  EXPECT_TRUE(refits()) << "how it looks, and masks, need no tree";
  CommitOptions other = always();
  other.tree.quality = BuildQuality::best;
  EXPECT_FALSE(scene.commit(other).refitted);
  CommitOptions braced = other;
  braced.tree = {.quality = BuildQuality::best, .geometry = other.tree.geometry};
  EXPECT_TRUE(scene.commit(braced).refitted) << "no binary form is asked for";
  other.tree.binary_form = true;
  scene.commit(other);
  EXPECT_FALSE(scene.commit(other).refitted) << "planes don't move";
}

TEST_P(Refit, MasksAloneKeepTheTree) {
  const Cube cube;
  Scene scene;
  const GeometryId id = scene.add_mesh({cube.vertices, cube.triangles}, {.mask = 1});
  scene.commit(always());
  scene.set_mask(id, 2);
  const CommitReport report = scene.commit(always());
  EXPECT_TRUE(report.refitted);
  EXPECT_EQ(report.growth, 1);
  const std::vector<double> from = {0, 0, 9}, down = {0.01, 0, -1};
  std::vector<std::uint8_t> hit(1);
  for (const std::uint32_t mask : {1u, 2u}) {
    scene.any({from, down, {}, {}, std::vector<std::uint32_t>{mask}}, hit);
    EXPECT_EQ(hit[0], mask == 2);
  }
}

TEST_P(Refit, BuildsWhereRaysWouldCostTooMuch) {
  const Arrays mesh = ball(16);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  const std::vector<double> strewn =
      mesh.moved([&](const dvec3&) { return dvec3(anywhere(random), anywhere(random), anywhere(random)); });
  Scene scene;
  const GeometryId id = scene.add_mesh({mesh.vertices, mesh.triangles});
  scene.commit(options(1.5));
  scene.update_vertices(id, strewn);
  const CommitReport report = scene.commit(options(1.5));
  EXPECT_FALSE(report.refitted);
  EXPECT_GT(report.growth, 1.5);
  EXPECT_TRUE(scene.commit(options(1.5)).refitted) << "it is as it was built";
  Scene kept;
  kept.add_mesh({mesh.vertices, mesh.triangles});
  kept.commit(always());
  kept.update_vertices(id, strewn);
  EXPECT_TRUE(kept.commit(always()).refitted);
  EXPECT_TRUE(kept.commit(always()).refitted) << "nothing has changed";
  EXPECT_FALSE(kept.commit(options(1.5)).refitted) << "what was kept has grown by more than this";
}

// Triangles that lose their area, degenerate or not, are other triangles; so is one that gets its area back.
TEST_P(Refit, BuildsWhereOtherTrianglesAreLeft) {
  Arrays mesh = ball(8);
  Twins twins;
  const GeometryId id = twins.add(mesh);
  twins.both([&](Scene& scene) { scene.commit(always()); });
  const auto commit = [&](const std::vector<double>& vertices) {
    twins.both([&](Scene& scene) { scene.update_vertices(id, vertices); });
    const bool refitted = twins.fitted.commit(always()).refitted;
    twins.built.commit(never());
    Asking(2000, vertices).expect_same(twins.fitted, twins.built);
    return refitted;
  };
  std::vector<double> collapsed = mesh.vertices, flattened = mesh.vertices;
  const std::array<std::uint32_t, 3> one = {mesh.triangles[300], mesh.triangles[301], mesh.triangles[302]};
  for (std::size_t k = 0; k < 3; ++k) {
    collapsed[3 * one[1] + k] = collapsed[3 * one[0] + k];
    for (std::size_t c = 0; c < 3; ++c)  // on a line, exactly
      flattened[3 * one[c] + k] = 0.5 + 0.125 * static_cast<double>(c * (k + 1));
  }
  EXPECT_FALSE(commit(collapsed));
  EXPECT_TRUE(commit(collapsed)) << "what is gone stays gone";
  EXPECT_FALSE(commit(mesh.vertices));
  EXPECT_FALSE(commit(flattened));
  for (double& x : flattened) x *= 0.75;  // by which no line is bent
  EXPECT_TRUE(commit(flattened));
  EXPECT_FALSE(commit(mesh.vertices));
  EXPECT_FALSE(commit(mesh.moved([](const dvec3&) { return dvec3(1, 2, 3); }))) << "nothing is left";
  EXPECT_FALSE(commit(mesh.vertices));
}

// A mesh that has left its space gets another one, and a new tree; within it all keeps its bits.
TEST_P(Refit, BuildsInAnotherSpaceFarOff) {
  const Arrays mesh = ball(12);
  Twins twins;
  const GeometryId id = twins.add(mesh);
  twins.both([&](Scene& scene) { scene.commit(always()); });
  const auto space = [](const Scene& scene) { return scene.prepared().prepared().geometry.space; };
  const auto commit = [&](double scale, double offset) {
    const std::vector<double> vertices =
        mesh.moved([&](const dvec3& v) { return scale * v + dvec3(offset, 0, 0); });
    twins.both([&](Scene& scene) { scene.update_vertices(id, vertices); });
    const bool refitted = twins.fitted.commit(always()).refitted;
    twins.built.commit(never());
    EXPECT_EQ(space(twins.fitted), space(twins.built));
    Asking(2000, vertices).expect_same(twins.fitted, twins.built);
    return refitted;
  };
  EXPECT_TRUE(commit(1, 0.5));
  EXPECT_TRUE(commit(1.5, 0));
  EXPECT_FALSE(commit(1, 1e6));
  EXPECT_TRUE(commit(1, 1e6 + 0.25));
  EXPECT_FALSE(commit(1e-3, 1e6)) << "it is too small for its space";
  EXPECT_FALSE(commit(1, 0));
}

TEST_P(Refit, RefusesWhatIsNoVertexAndGoesOn) {
  const Cube cube;
  Scene scene;
  const GeometryId id = scene.add_mesh({cube.vertices, cube.triangles});
  scene.commit(always());
  std::vector<float> bad = cube.vertices;
  bad[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(fails([&] { scene.update_vertices(id, bad); }, "vertices[1]: not finite"));
  EXPECT_TRUE(scene.commit(always()).refitted);
  EXPECT_TRUE(
      fails([&] { scene.commit(options(std::nan(""))); }, "refit_growth is not a number", ErrorCode::usage));
}

TEST_P(Refit, NormalsTurnWithTheVertices) {
  const Arrays mesh = ball(12);
  const auto normals = [](const std::vector<double>& vertices) { return vertices; };  // of a ball about 0
  Twins twins;
  twins.both([&](Scene& scene) {
    const GeometryId id = scene.add_mesh({mesh.vertices, mesh.triangles, normals(mesh.vertices)});
    scene.add_light({.position = {5, 6, 7}});
    scene.commit(always());
    const std::vector<double> vertices = mesh.moved(turned);
    scene.update_vertices(id, vertices, normals(vertices));
    EXPECT_EQ(scene.commit(&scene == &twins.fitted ? always() : never()).refitted, &scene == &twins.fitted);
  });
  RenderOptions picture;
  picture.width = picture.height = 64;
  EXPECT_TRUE(twins.fitted.render(picture).rgb == twins.built.render(picture).rgb);
}

// ---- Threads: each answer is that of one state or of the next, never of something between.

TEST_P(Refit, OthersAreAnsweredFromTheStateBefore) {
  const Arrays mesh = ball(24);
  const Asking asking(1500, mesh.vertices);
  constexpr int kStates = 4;
  std::vector<std::vector<double>> states;
  std::vector<std::vector<std::uint8_t>> answers;
  Scene scene;
  scene.add_mesh({mesh.vertices, mesh.triangles});
  scene.commit(always());
  for (int i = 0; i < kStates; ++i) {
    states.push_back(mesh.moved([&](const dvec3& v) { return v + 0.05 * i * (bent(v) - v); }));
    scene.update_vertices(0, states.back());
    scene.commit(never());
    answers.push_back(asking.closest(scene, {asking.origins, asking.directions}));
  }
  std::atomic<bool> over{false};
  std::atomic<int> wrong{0}, asked{0};
  const auto ask = [&] {
    while (!over) {
      const std::vector<std::uint8_t> answer = asking.closest(scene, {asking.origins, asking.directions});
      wrong += std::find(answers.begin(), answers.end(), answer) == answers.end() ? 1 : 0;
      ++asked;
    }
  };
  std::thread one(ask), two(ask);
  int refitted = 0;
  for (int round = 0; round < 40 || asked < 20; ++round) {
    scene.update_vertices(0, states[static_cast<std::size_t>(round) % kStates]);
    refitted += scene.commit(always()).refitted;
  }
  over = true;
  one.join();
  two.join();
  EXPECT_EQ(wrong, 0) << "of " << asked;
  EXPECT_GE(refitted, 40);
}

}  // namespace
}  // namespace kdray
