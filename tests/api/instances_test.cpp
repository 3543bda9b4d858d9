// Instances that a program adds: what is refused and how it is told; pictures and hits that are those of the
// same scene from a file and of copies; and commits after which only instances have moved, which are those
// of a scene that is built.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "accel/prepare/prepared.h"
#include "kdray/kdray.h"
#include "scene/model/instances.h"
#include "scene/model/scene.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/folder.h"
#include "support/meshes.h"

namespace kdray {
namespace {

using test::Cube;
using test::fails;

constexpr unsigned kSeed = 28;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Matrix = std::array<double, 12>;

constexpr Matrix kHere = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

Matrix at(double x, double y, double z, double size = 1) {
  return {size, 0, 0, x, 0, size, 0, y, 0, 0, size, z};
}

// Turned about y, mirrored where `size` is below 0.
Matrix turned(double angle, double size, double x, double y, double z) {
  const double c = std::cos(angle), s = std::sin(angle), up = std::abs(size);
  return {size * c, 0, up * s, x, 0, up * 0.75, 0, y, -size * s, 0, up * c, z};
}

std::vector<Matrix> many_turned(int n, unsigned seed) {
  std::mt19937 bits(seed);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(bits); };
  std::vector<Matrix> all;
  for (int i = 0; i < n; ++i)
    all.push_back(turned(in(0, 6), (i % 2 ? -1 : 1) * in(0.1, 0.4), in(-2, 2), in(-1, 1), in(-2, 2)));
  return all;
}

std::vector<double> numbers(const std::vector<Matrix>& matrices) {
  std::vector<double> all;
  for (const Matrix& m : matrices) all.insert(all.end(), m.begin(), m.end());
  return all;
}

struct Answers {
  explicit Answers(std::size_t n) : t(n), geometry(n), primitive(n), instance(n), normal(n) {}
  HitsOut out() {
    return {.t = t, .geometry = geometry, .primitive = primitive, .normal = normal, .instance = instance};
  }
  bool operator==(const Answers&) const = default;

  std::vector<double> t;
  std::vector<std::uint32_t> geometry, primitive, instance;
  std::vector<std::array<double, 3>> normal;
};

Answers asked(const Scene& scene, const std::vector<double>& origins, const std::vector<double>& directions,
              const std::vector<std::uint32_t>& masks = {}) {
  Answers a(std::max(origins.size(), directions.size()) / 3);
  scene.closest({origins, directions, {}, {}, masks}, a.out());
  return a;
}

class MadeInstances : public test::EachDevice {
 protected:
  CommitOptions options() const {
    CommitOptions options;
    options.device.device = GetParam();
    return options;
  }
};
KDRAY_FOR_EACH_DEVICE(MadeInstances);

// ---- What is refused

TEST(Instances, NamesTheTransformThatIsWrong) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  const auto refused = [&](Matrix wrong, const char* what) {
    const std::vector<double> all = numbers({kHere, wrong});
    return fails([&] { scene.add_instances(box, all); },
                 std::string("transforms[1]: a transform that ") + what);
  };
  Matrix m = kHere;
  m[3] = kInfinity;
  EXPECT_TRUE(refused(m, "is not finite"));
  m = kHere, m[5] = std::nan("");
  EXPECT_TRUE(refused(m, "is not finite"));
  m = kHere, m[5] = 0;
  EXPECT_TRUE(refused(m, "flattens"));
  m = kHere, m[0] = 1e-3;
  EXPECT_TRUE(refused(m, "stretches"));
  EXPECT_EQ(scene.geometries().size(), 1u) << "what was refused has left nothing behind";

  const std::vector<double> two = numbers({kHere, at(3, 0, 0)});
  const GeometryId both = scene.add_instances(box, two);
  EXPECT_TRUE(fails([&] { scene.update_transforms(both, numbers({kHere})); }, "there are 2 instances"));
  m = kHere, m[0] = 0;
  EXPECT_TRUE(fails([&] { scene.update_transforms(both, numbers({m, kHere})); }, "transforms[0]"));
  EXPECT_TRUE(fails([&] { scene.update_transforms(box, two); }, "only instances", ErrorCode::usage));
}

TEST(Instances, AreOfPrototypesAlone) {
  const Cube cube;
  Scene scene;
  const std::vector<double> here = numbers({kHere});
  const GeometryId plain = scene.add_mesh({cube.vertices, cube.triangles});
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.name = "box", .prototype = true});
  const GeometryId some = scene.add_instances(box, here, {.name = "some"});
  EXPECT_TRUE(fails([&] { scene.add_instances(plain, here); }, "no prototype", ErrorCode::usage));
  EXPECT_TRUE(fails([&] { scene.add_instances(some, here); }, "instances itself", ErrorCode::usage));
  EXPECT_TRUE(fails([&] { scene.add_instances(99, here); }, "no geometry 99", ErrorCode::usage));
  EXPECT_TRUE(fails([&] { scene.remove(box); }, "has instances", ErrorCode::usage));
  EXPECT_TRUE(fails([&] { scene.set_mask(box, 1); }, "no mask", ErrorCode::usage));
  const std::vector<std::uint32_t> materials = {7}, three(3, 0);
  EXPECT_TRUE(fails([&] { scene.add_instances(box, here, {.materials = materials}); }, "no material 7",
                    ErrorCode::usage));
  EXPECT_TRUE(fails([&] { scene.add_instances(box, here, {.materials = three}); }, "materials: 3 of them"));
  EXPECT_EQ(scene.info(some).instances, 1u);
  EXPECT_EQ(scene.info(some).primitives, 12u);
  EXPECT_TRUE(scene.info(box).prototype);
  EXPECT_EQ(scene.primitives(), 12u) << "those that are seen themselves";
  scene.remove(some);
  scene.remove(box);
  EXPECT_EQ(scene.geometries(), (std::vector<GeometryId>{plain}));
}

// ---- What is seen

TEST_P(MadeInstances, TellGeometryInstanceAndPrimitive) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  const GeometryId floor = scene.add_mesh({cube.at(0, 0, -9), cube.triangles});
  Matrix mirrored = at(20, 0, 0);
  mirrored[10] = -1;
  const GeometryId first = scene.add_instances(box, numbers({at(5, 0, 0), at(10, 0, 0, 2)}));
  const GeometryId second = scene.add_instances(box, numbers({mirrored}));
  scene.commit(options());
  const Answers a =
      asked(scene, {5.5, 0.25, 9, 10.5, 0.25, 9, 20.5, 0.25, 9, 0.5, 0.25, 9, 40, 0, 9}, {0, 0, -1});
  EXPECT_EQ(a.geometry, (std::vector<std::uint32_t>{first, first, second, floor, kNoGeometry}));
  EXPECT_EQ(a.instance, (std::vector<std::uint32_t>{0, 1, 0, kNoInstance, kNoInstance}));
  EXPECT_EQ(a.t, (std::vector<double>{8, 7, 8, 17, kInfinity}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.normal[i], (std::array<double, 3>{0, 0, 1})) << i;
  // The same face of the prototype, but for the one that is upside down.
  EXPECT_EQ(a.primitive[0], a.primitive[1]);
  EXPECT_EQ(a.primitive[0], a.primitive[3]);
  EXPECT_NE(a.primitive[0], a.primitive[2]);
  std::vector<std::uint8_t> hit(2);
  const std::vector<double> from = {5.5, 0.25, 9, 40, 0, 9}, down = {0, 0, -1};
  scene.any({from, down}, hit);
  EXPECT_EQ(hit, (std::vector<std::uint8_t>{1, 0}));
  const auto extent = scene.extent();
  ASSERT_TRUE(extent);
  EXPECT_NEAR(extent->greatest[0], 21, 1e-3);
}

// In double: the cube's own normal by the inverse transpose, which docs/embed.md promises to c * 2^-22.
TEST_P(MadeInstances, NormalsAreRightToTheConditionOfTheTransform) {
  const Cube cube;
  std::mt19937 bits(kSeed);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(bits); };
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  std::vector<scene::Instance> placed;
  std::vector<Matrix> places;
  while (placed.size() < 300) {
    scene::Instance instance;
    Matrix m{};
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        instance.linear[column][row] = m[static_cast<std::size_t>(4 * row + column)] = in(-1, 1);
    instance.move.x = m[3] = 5.0 * static_cast<double>(placed.size());
    if (scene::fault_of(instance) != nullptr) continue;
    placed.push_back(instance);
    places.push_back(m);
  }
  scene.add_instances(box, numbers(places));
  scene.commit(options());
  std::vector<double> from, to;
  for (const scene::Instance& instance : placed) {
    const dvec3 aim(in(-1, 1), in(-1, 1), in(-1, 1));
    from.insert(from.end(), {instance.move.x + aim.x, aim.y, 9});
    to.insert(to.end(), {-aim.x, -aim.y, -9});
  }
  const Answers a = asked(scene, from, to);
  int n = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (a.instance[i] != i) continue;  // a neighbour is in the way
    const std::uint32_t* const t = &cube.triangles[3 * a.primitive[i]];
    const auto corner = [&](int k) {
      const float* const v = &cube.vertices[3 * t[k]];
      return dvec3(v[0], v[1], v[2]);
    };
    const dvec3 own = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    const dvec3 expected = glm::normalize(glm::transpose(glm::inverse(placed[i].linear)) * own);
    const dvec3 told(a.normal[i][0], a.normal[i][1], a.normal[i][2]);
    EXPECT_LE(glm::length(told - expected), scene::condition_of(placed[i].linear) * 0x1p-22) << i;
    ++n;
  }
  EXPECT_GT(n, 200);
}

TEST_P(MadeInstances, AreSeenByMaskAndWhereTheyAreEnabled) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  const GeometryId own = scene.add_mesh({cube.at(0, 0, -9), cube.triangles}, {.mask = 4});
  const GeometryId near = scene.add_instances(box, numbers({at(0, 0, 6)}), {.mask = 1});
  const GeometryId far = scene.add_instances(box, numbers({at(0, 0, 0), at(50, 0, 0)}), {.mask = 2});
  scene.commit(options());
  const std::vector<double> from = {0.25, 0.5, 20}, down = {0, 0, -1};
  const auto seen_by = [&](std::uint32_t mask, std::size_t n) {
    // Few rays and packets of them.
    std::vector<double> origins, directions;
    for (std::size_t i = 0; i < n; ++i) {
      origins.insert(origins.end(), from.begin(), from.end());
      directions.insert(directions.end(), down.begin(), down.end());
    }
    const Answers a = asked(scene, origins, directions, std::vector<std::uint32_t>(n, mask));
    for (const std::uint32_t geometry : a.geometry) EXPECT_EQ(geometry, a.geometry[0]);
    return a.geometry[0];
  };
  for (const std::size_t n : {1u, 64u}) {
    EXPECT_EQ(seen_by(7, n), near);
    EXPECT_EQ(seen_by(6, n), far);
    EXPECT_EQ(seen_by(4, n), own);
    EXPECT_EQ(seen_by(8, n), kNoGeometry);
  }
  scene.set_mask(near, 8);
  scene.commit(options());
  EXPECT_EQ(seen_by(3, 16), far);
  EXPECT_EQ(seen_by(8, 16), near);
  scene.enable(near, false);
  scene.commit(options());
  EXPECT_EQ(seen_by(11, 16), far);
  scene.enable(box, false);  // and with it all instances
  scene.commit(options());
  EXPECT_EQ(seen_by(15, 16), own);
}

// Files, and what a program adds beside them: each has its own numbers.
TEST_P(MadeInstances, OfAFileAreGeometry0) {
  const test::Folder folder;
  folder.put("box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto file = folder.put("s.json", R"({"objects": [{"type": "mesh", "file": "box.obj", "instances": [
      {"translate": [3, 0, 0]}, {"translate": [6, 0, 0]}]}]})");
  Scene scene = Scene::load(file, {.instances = Instances::kept});
  EXPECT_EQ(scene.info(0).instances, 2u);
  const Cube cube;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  const GeometryId added = scene.add_instances(box, numbers({at(9, 0, 0), at(12, 0, 0)}));
  scene.commit(options());
  const std::vector<double> from = {3.25, 0.25, 5, 6.25, 0.25, 5, 9.25, 0.25, 5, 12.25, 0.25, 5};
  const Answers all = asked(scene, from, {0, 0, -1});
  EXPECT_EQ(all.geometry, (std::vector<std::uint32_t>{0, 0, added, added}));
  EXPECT_EQ(all.instance, (std::vector<std::uint32_t>{0, 1, 0, 1}));
  EXPECT_EQ(all.primitive[0], 0u);
  scene.remove(0);
  scene.commit(options());
  const Answers rest = asked(scene, from, {0, 0, -1});
  EXPECT_EQ(rest.geometry, (std::vector<std::uint32_t>{kNoGeometry, kNoGeometry, added, added}));
  EXPECT_EQ(rest.instance[3], 1u);
}

std::string rows_of(const Matrix& m) {
  std::string text;
  for (const double v : m) text += fmt::format("{:.17g}, ", v);
  return text + "0, 0, 0, 1";
}

// The same scene twice: in kdray's JSON, and by this interface.
class InBothWays {
 public:
  explicit InBothWays(const std::vector<Matrix>& places) {
    folder_.put("cube.obj", obj());
    std::string instances;
    for (std::size_t i = 0; i < places.size(); ++i)
      instances += fmt::format(R"({}{{"matrix": [{}]{}}})", i ? ", " : "", rows_of(places[i]),
                               i % 3 == 1 ? R"(, "material": "blue")" : "");
    const std::string text = R"({"camera": {"from": [1, 2, 6], "at": [0, 0, 0], "fov": 50},
      "background": [0.25, 0.25, 0.5], "ambient": 0.5,
      "materials": {"red": {"ka": [0.125, 0, 0], "kd": [0.75, 0.25, 0.125], "ks": 0.25, "shine": 8,
                            "reflect": 0.125},
                    "blue": {"ka": 0, "kd": [0, 0.25, 0.5]}},
      "lights": [{"type": "point", "position": [4, 7, 5], "color": 0.875}],
      "objects": [{"type": "mesh", "file": "cube.obj", "material": "red", "instances": [)" +
                             instances +
                             R"(]}, {"type": "triangles", "material": "blue",
        "vertices": [[-5, -2, -5], [-5, -2, 5], [5, -2, 5], [5, -2, -5]],
        "faces": [[0, 1, 2], [0, 2, 3]]}]})";
    file = Scene::load(folder_.put("s.json", text), {.instances = Instances::kept});
    make(places);
  }

  Scene file, made;
  GeometryId boxes = 0;

 private:
  static std::string obj() {
    const Cube cube;
    std::string text;
    for (std::size_t i = 0; i < cube.vertices.size(); i += 3)
      text += fmt::format("v {} {} {}\n", cube.vertices[i], cube.vertices[i + 1], cube.vertices[i + 2]);
    for (std::size_t i = 0; i < cube.triangles.size(); i += 3)
      text += fmt::format("f {} {} {}\n", cube.triangles[i] + 1, cube.triangles[i + 1] + 1,
                          cube.triangles[i + 2] + 1);
    return text;
  }
  void make(const std::vector<Matrix>& places) {
    const Cube cube;
    const MaterialId red = made.add_material({.ambient = {0.125f, 0, 0},
                                              .diffuse = {0.75f, 0.25f, 0.125f},
                                              .specular = {0.25f, 0.25f, 0.25f},
                                              .reflect = {0.125f, 0.125f, 0.125f},
                                              .shine = 8});
    const MaterialId blue = made.add_material({.ambient = {0, 0, 0}, .diffuse = {0, 0.25f, 0.5f}});
    made.set_camera({.from = {1, 2, 6}, .at = {0, 0, 0}, .fov = 50});
    made.set_background({0.25f, 0.25f, 0.5f});
    made.set_ambient({0.5f, 0.5f, 0.5f});
    made.add_light({.position = {4, 7, 5}, .color = {0.875f, 0.875f, 0.875f}});
    const GeometryId box =
        made.add_mesh({cube.vertices, cube.triangles}, {.material = red, .prototype = true});
    std::vector<std::uint32_t> materials;
    for (std::size_t i = 0; i < places.size(); ++i) materials.push_back(i % 3 == 1 ? blue : kOwnMaterial);
    boxes = made.add_instances(box, numbers(places), {.materials = materials});
    const std::vector<double> corners = {-5, -2, -5, -5, -2, 5, 5, -2, 5, 5, -2, -5};
    const std::vector<std::uint32_t> floor = {0, 1, 2, 0, 2, 3};
    made.add_mesh({corners, floor}, {.material = blue});
  }

  test::Folder folder_;
};

RenderOptions picture_of(Mode mode = Mode::automatic) {
  RenderOptions picture;
  picture.width = 96, picture.height = 72;
  picture.mode = mode;
  return picture;
}

TEST_P(MadeInstances, PicturesAreThoseOfTheSameSceneInJson) {
  InBothWays scene(many_turned(60, kSeed));
  ASSERT_EQ(scene.file.model().instances.size(), 60u);
  DeviceOptions device;
  device.device = GetParam();
  for (const Mode mode : {Mode::pdprt, Mode::odprt}) {
    const Picture a = Renderer(scene.file, {}, device).render(picture_of(mode)),
                  b = Renderer(scene.made, {}, device).render(picture_of(mode));
    EXPECT_EQ(a.rgb, b.rgb) << static_cast<int>(mode);
  }
}

template <class T>
bool same_bytes(const Array<T>& a, const Array<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.bytes()) == 0;
}

// A commit after which only instances have moved keeps all but the tree over them, and comes to what a build
// in the same space comes to.
TEST_P(MadeInstances, ThatMoveAreAsIfTheyWereBuilt) {
  InBothWays scene(many_turned(60, kSeed));
  EXPECT_FALSE(scene.made.commit(options()).refitted);
  for (unsigned step = 1; step < 4; ++step) {
    const std::vector<Matrix> places = many_turned(60, kSeed + step);
    scene.made.update_transforms(scene.boxes, numbers(places));
    const CommitReport report = scene.made.commit(options());
    EXPECT_TRUE(report.refitted) << step;
    const auto prepared = scene.made.prepared();
    const prepare::Prepared& fast = prepared.prepared();
    const prepare::Prepared built = prepare::prepare(scene.made.model(), options().tree, fast.geometry.space);
    EXPECT_TRUE(same_bytes(fast.wide.nodes, built.wide.nodes)) << step;
    EXPECT_TRUE(same_bytes(fast.flat.instances, built.flat.instances)) << step;
    EXPECT_TRUE(same_bytes(fast.flat.lights, built.flat.lights)) << step;
    EXPECT_EQ(fast.features, built.features);
    EXPECT_EQ(fast.wide.stack_size, built.wide.stack_size);
    EXPECT_EQ(fast.wide.widen, built.wide.widen);
    EXPECT_EQ(fast.geometry.bounds.lo, built.geometry.bounds.lo);
    InBothWays fresh(places);
    fresh.made.commit(options());
    EXPECT_EQ(scene.made.render(picture_of()).rgb, fresh.made.render(picture_of()).rgb) << step;
  }
  EXPECT_TRUE(scene.made.commit(options()).refitted) << "nothing has changed";
  CommitOptions always = options();
  always.refit_growth = 0;
  EXPECT_FALSE(scene.made.commit(always).refitted);
  // Beyond the space that the scene has, or with another prototype, it is built.
  scene.made.update_transforms(scene.boxes, numbers(std::vector<Matrix>(60, at(1000, 0, 0))));
  EXPECT_FALSE(scene.made.commit(options()).refitted);
  const Answers far = asked(scene.made, {1000, 0, 9}, {0, 0, -1});
  EXPECT_EQ(far.instance[0], 0u) << "of sixty in one place the first";
}

TEST_P(MadeInstances, OfAPrototypeWhoseVerticesMoveAreBuilt) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  scene.add_instances(box, numbers({at(5, 0, 0)}));
  scene.commit(options());
  scene.update_vertices(box, cube.at(0, 0, 2));
  EXPECT_FALSE(scene.commit(options()).refitted);
  EXPECT_EQ(asked(scene, {5.25, 0.5, 9}, {0, 0, -1}).t[0], 6);
}

// Prototypes of every kind, in a scene of nothing else; one that is empty, and none.
TEST_P(MadeInstances, OfEveryKindAndOfNothing) {
  Scene scene;
  const std::vector<double> origin = {0, 0, 0}, up = {0, 0, 1}, one = {1}, quarter = {0.25};
  const GeometryId ball = scene.add_spheres({origin, one}, {.prototype = true}),
                   disc = scene.add_discs({origin, up, one}, {.prototype = true}),
                   rod = scene.add_cones({origin, up, one, one}, {.prototype = true}),
                   ring = scene.add_tori({origin, up, one, quarter}, {.prototype = true}),
                   nothing = scene.add_spheres({{}, one}, {.prototype = true});
  scene.add_instances(nothing, numbers({kHere, kHere}));
  Matrix egg = at(0, 0, 0);
  egg[10] = 3;  // an ellipsoid, three times as high
  Matrix high = at(30, 0, 0);
  high[10] = 2;
  const GeometryId eggs = scene.add_instances(ball, numbers({egg})),
                   discs = scene.add_instances(disc, numbers({at(10, 0, 0)})),
                   rods = scene.add_instances(rod, numbers({at(20, 0, 0)})),
                   rings = scene.add_instances(ring, numbers({high})),
                   none = scene.add_instances(ball, std::vector<double>());
  scene.commit(options());
  const Answers a = asked(scene, {0, 0, 9, 10, 0.5, 9, 25, 0, 0.5, 0.6, 0, 9, 31.15, 0, 9, 30, 0, 9},
                          {0, 0, -1, 0, 0, -1, -1, 0, 0, 0, 0, -1, 0, 0, -1, 0, 0, -1});
  EXPECT_EQ(a.geometry, (std::vector<std::uint32_t>{eggs, discs, rods, eggs, rings, kNoGeometry}))
      << "the last goes through the hole";
  EXPECT_NEAR(a.t[0], 6, 1e-6);
  EXPECT_NEAR(a.t[1], 9, 1e-6);
  EXPECT_NEAR(a.t[2], 4, 1e-6);
  EXPECT_NEAR(a.t[3], 9 - 3 * 0.8, 1e-5);
  // Of x^2 + y^2 + z^2/9 = 1 at (0.6, 0, 2.4) the gradient is (1.2, 0, 4.8/9).
  const double length = std::hypot(1.2, 4.8 / 9);
  EXPECT_NEAR(a.normal[3][0], 1.2 / length, 1e-5);
  EXPECT_NEAR(a.normal[3][2], 4.8 / 9 / length, 1e-5);
  // The tube's circle is 0.15^2 + 0.2^2 = 0.25^2 there, and twice as high: the gradient is (0.15, 0, 0.2/2).
  EXPECT_NEAR(a.t[4], 9 - 2 * 0.2, 1e-5);
  EXPECT_NEAR(a.normal[4][0], 0.15 / std::hypot(0.15, 0.1), 1e-5);
  EXPECT_NEAR(a.normal[4][2], 0.1 / std::hypot(0.15, 0.1), 1e-5);
  EXPECT_EQ(scene.info(none).instances, 0u);
}

TEST_P(MadeInstances, RaysThatMeanNothingAreMissesOrErrors) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  scene.add_instances(box, numbers({at(0, 0, 0), at(1, 0, 0)}));
  scene.commit(options());
  const double nan = std::nan("");
  const std::vector<double> from = {0.5, 0.5,       9, nan, 0,   9, 0.5,  0.5, 9,
                                    0.5, kInfinity, 9, 0.5, 0.5, 9, 1e30, 0,   0},
                            to = {0, 0, -1, 0, 0, -1, 0, 0, 0, 0, 0, -1, nan, 0, -1, -1, 0, 0};
  EXPECT_TRUE(fails([&] { asked(scene, from, to); }, "ray 1"));
  Answers a(6);
  const QueryReport report = scene.closest({from, to}, a.out(), {.invalid = InvalidRays::miss});
  EXPECT_EQ(report.invalid, 4u);
  EXPECT_EQ(a.t[0], 8);
  EXPECT_EQ(a.instance[0], 0u);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(a.instance[i], kNoInstance) << i;
  EXPECT_EQ(a.instance[5], 1u) << "a double's ray from far off begins where it enters the scene";
}

TEST_P(MadeInstances, CrossingsTellInstancesAndWhatIsInside) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  const GeometryId own = scene.add_mesh({cube.at(0, 0, -9), cube.triangles}, {.mask = 4});
  const GeometryId some = scene.add_instances(box, numbers({at(0, 0, 0), at(0, 0, 5, 0.5)}), {.mask = 2});
  scene.commit(options());
  const std::vector<double> from = {0.25, 0.125, 20}, down = {0, 0, -1};
  const AllHits all = scene.all({from, down});
  const double expected[] = {14.5, 15.5, 19, 21, 28, 30};
  ASSERT_EQ(all.t.size(), std::size(expected));
  for (std::size_t i = 0; i < all.t.size(); ++i) EXPECT_NEAR(all.t[i], expected[i], 1e-5);
  EXPECT_EQ(all.geometry, (std::vector<std::uint32_t>{some, some, some, some, own, own}));
  EXPECT_EQ(all.instance, (std::vector<std::uint32_t>{1, 1, 0, 0, kNoInstance, kNoInstance}));
  const auto count = [&](std::uint32_t mask) {
    std::vector<std::uint32_t> n(1);
    const std::vector<std::uint32_t> masks = {mask};
    scene.count({from, down, {}, {}, masks}, n);
    return n[0];
  };
  EXPECT_EQ(count(6), 6u);
  EXPECT_EQ(count(2), 4u);
  EXPECT_EQ(count(4), 2u);
  EXPECT_EQ(count(1), 0u);
  const std::vector<double> points = {0.5, 0.25, 0.125, 0, 0, 5.25, 0, 0, 6, 0, 0, -9, 0, 0, -3};
  std::vector<std::uint8_t> in(5);
  scene.inside(points, in);
  EXPECT_EQ(in, (std::vector<std::uint8_t>{1, 1, 0, 1, 0}));
}

// What can't follow instances yet says so.
TEST_P(MadeInstances, OtherQuestionsAreRefusedInOneLine) {
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  scene.add_instances(box, numbers({kHere}));
  scene.commit(options());
  const std::vector<double> from = {0, 0, 9}, down = {0, 0, -1};
  std::vector<double> distance(1);
  EXPECT_TRUE(
      fails([&] { scene.closest_points(from, {.distance = distance}); }, "closest points", ErrorCode::usage));
  EXPECT_TRUE(fails([&] { scene.signed_distance(from, distance); }, "distances", ErrorCode::usage));
}

// A grid of a million, of which every ray's hit is known.
TEST_P(MadeInstances, AMillion) {
  constexpr int kSide = 1000;
  const Cube cube;
  Scene scene;
  const GeometryId box = scene.add_mesh({cube.vertices, cube.triangles}, {.prototype = true});
  std::vector<float> places;
  places.reserve(12u * kSide * kSide);
  for (int x = 0; x < kSide; ++x)
    for (int y = 0; y < kSide; ++y) {
      const float row[12] = {0.25f, 0, 0, float(x), 0, 0.25f, 0, float(y), 0, 0, 0.25f, 0};
      places.insert(places.end(), row, row + 12);
    }
  const GeometryId all = scene.add_instances(box, places);
  EXPECT_FALSE(scene.commit(options()).refitted);
  std::mt19937 bits(kSeed);
  std::uniform_int_distribution<int> cell(0, kSide - 1);
  std::uniform_real_distribution<double> within(-0.45, 0.45);
  std::vector<double> from;
  std::vector<std::uint32_t> expected;
  for (int i = 0; i < 20000; ++i) {
    const int x = cell(bits), y = cell(bits);
    const double u = within(bits), v = within(bits);
    if (std::abs(std::abs(u) - 0.25) < 1e-3 || std::abs(std::abs(v) - 0.25) < 1e-3) continue;
    from.insert(from.end(), {x + u, y + v, 3});
    const bool hit = std::abs(u) < 0.25 && std::abs(v) < 0.25;
    expected.push_back(hit ? static_cast<std::uint32_t>(x * kSide + y) : kNoInstance);
  }
  const auto check = [&](double t) {
    const Answers a = asked(scene, from, {0, 0, -1});
    EXPECT_EQ(a.instance, expected);
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (expected[i] != kNoInstance) {
        ASSERT_NEAR(a.t[i], t, 1e-3);
      }
    EXPECT_EQ(a.geometry[0] == all, expected[0] != kNoInstance);
  };
  check(2.75);
  for (std::size_t i = 11; i < places.size(); i += 12) places[i] = 0.5f;
  scene.update_transforms(all, places);
  EXPECT_TRUE(scene.commit(options()).refitted);
  check(2.25);
}

}  // namespace
}  // namespace kdray
