// What    What kdray trace asks beside the closest hits of float rays, through the real program: answers of
//         known shape and value about a box, and what is refused.
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/cli/npy_files.h"
#include "apps/cli/program.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;

constexpr double kEver = std::numeric_limits<double>::infinity();

// From (0, 0, 0) to (1, 1, 1): each face of two triangles that share its diagonal.
constexpr const char* kBox =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

template <class T>
using BoxRay = std::array<T, 8>;

// Down through the box, off its diagonals and on one; out of it; short of it; beside it.
template <class T>
std::vector<BoxRay<T>> box_rays() {
  const T ever = std::numeric_limits<T>::infinity();
  return {{T(0.25), T(0.5), 5, 0, 0, 0, -2, ever},
          {T(0.5), T(0.5), 5, 0, 0, 0, -1, ever},
          {T(0.25), T(0.5), T(0.75), 0, 0, 0, -1, ever},
          {T(0.25), T(0.5), 5, 0, 0, 0, -1, T(3.5)},
          {9, 9, 9, 0, 0, 0, -1, ever}};
}

struct Asking {
  Folder folder;
  fs::path scene = folder.put("box.obj", kBox);
  fs::path floats = folder.put("r4.npy", npy_of("<f4", box_rays<float>()));
  fs::path doubles = folder.put("r8.npy", npy_of("<f8", box_rays<double>()));

  Outcome run(std::vector<std::string> arguments, const std::string& output) const {
    std::vector<std::string> all = {"trace", scene, "-o", folder / output};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return kdray(all);
  }
};

struct __attribute__((packed)) DoubleHit {
  double t;
  std::int32_t primitive;
  float u, v;
};
static_assert(sizeof(DoubleHit) == 20);
const std::string kDoubleHits = "[('t', '<f8'), ('primitive', '<i4'), ('u', '<f4'), ('v', '<f4')]";

// Two squares of a million, 1e-10 apart: the upper one comes later in the file, and floats have both at one
// height.
TEST(Questions, DoubleGeometryIsThatOfTheFile) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  std::string squares;
  for (const char* z : {"0.3", "0.3000000001"})
    for (const char* xy : {"-5e5 -5e5 ", "5e5 -5e5 ", "5e5 5e5 ", "-5e5 5e5 "})
      squares += std::string("v ") + xy + z + "\n";
  squares += "v 0 0 -4e5\nf 1 2 3 4\nf 5 6 7 8\nf 1 2 9\n";
  const auto scene = asking.folder.put("squares.obj", squares);
  const auto rays = asking.folder.put(
      "down.npy", npy_of("<f8", std::vector<BoxRay<double>>{{7, 9, 5, 0, 0, 0, -1, kEver}}));
  const auto hit_of = [&](const char* geometry) {
    EXPECT_TRUE(succeeds(
        kdray({"trace", scene, "--rays", rays, "-o", asking.folder / "h.npy", "--geometry", geometry})));
    return values_of<DoubleHit>(asking.folder.get("h.npy"), kDoubleHits).at(0);
  };
  EXPECT_EQ(hit_of("double").primitive / 2, 1);
  EXPECT_DOUBLE_EQ(hit_of("double").t, 5 - 0.3000000001);
  EXPECT_EQ(hit_of("auto").t, hit_of("double").t);
  EXPECT_EQ(hit_of("float").primitive / 2, 0);
}

TEST(Questions, DoubleRaysHaveHitsInDouble) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  // From far off, where floats can't tell the box's faces apart.
  const auto far = asking.folder.put(
      "far.npy", npy_of("<f8", std::vector<BoxRay<double>>{{0.25, 0.5, 1e9, 0, 0, 0, -1, kEver}}));
  ASSERT_TRUE(succeeds(asking.run({"--rays", far}, "far_hits.npy")));
  EXPECT_EQ(values_of<DoubleHit>(asking.folder.get("far_hits.npy"), kDoubleHits).at(0).t, 1e9 - 1);

  ASSERT_TRUE(succeeds(asking.run({"--rays", asking.doubles}, "h.npy")));
  const auto hits = values_of<DoubleHit>(asking.folder.get("h.npy"), kDoubleHits);
  ASSERT_EQ(hits.size(), 5u);
  EXPECT_EQ(hits[0].t, 2.0);
  EXPECT_EQ(hits[1].t, 4.0);
  EXPECT_EQ(hits[2].t, 0.75);
  for (const std::size_t on_top : {0, 1}) EXPECT_EQ(hits[on_top].primitive / 2, 1);
  EXPECT_EQ(hits[2].primitive / 2, 0);
  for (const std::size_t missed : {3, 4}) {
    EXPECT_EQ(hits[missed].t, kEver);
    EXPECT_EQ(hits[missed].primitive, -1);
  }
  ASSERT_TRUE(succeeds(asking.run({"--rays", asking.doubles, "--any-hit"}, "any.npy")));
  const auto any = values_of<DoubleHit>(asking.folder.get("any.npy"), kDoubleHits);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(double{any[i].t}, i < 3 ? 0 : kEver) << i;
    EXPECT_EQ(std::int32_t{any[i].primitive}, -1) << i;
  }
}

TEST(Questions, AnNpzHasAnArrayForEachField) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  ASSERT_TRUE(succeeds(asking.run({"--rays", asking.floats}, "h.npz")));
  const auto files = files_of_npz(asking.folder.get("h.npz"));
  ASSERT_EQ(files.size(), 4u);
  EXPECT_EQ(values_of<float>(files.at("t"), "'<f4'").at(0), 2.0f);
  EXPECT_EQ(values_of<std::int32_t>(files.at("primitive"), "'<i4'").at(4), -1);
  EXPECT_EQ(values_of<float>(files.at("v"), "'shape': (5,)").size(), 5u);
}

TEST(Questions, CountsAreOfCrossings) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  for (const fs::path& rays : {asking.floats, asking.doubles}) {
    const Outcome run = asking.run({"--rays", rays, "--count", "--stats", asking.folder / "s.json"}, "c.npy");
    ASSERT_TRUE(succeeds(run));
    EXPECT_NE(run.err.find("5 crossings of 5 rays"), std::string::npos) << run.err;
    EXPECT_EQ(values_of<std::uint32_t>(asking.folder.get("c.npy"), "'<u4'"),
              (std::vector<std::uint32_t>{2, 2, 1, 0, 0}));
    const auto stats = nlohmann::json::parse(asking.folder.get("s.json"));
    EXPECT_EQ(stats["hits"]["asked"], "count");
    EXPECT_EQ(stats["hits"]["rays"], 5);
    EXPECT_EQ(stats["hits"]["hits"], 5);
    EXPECT_EQ(stats["rays"]["total"], 5);
    EXPECT_GT(stats["seconds"]["trace"], 0.0);
    EXPECT_GT(stats["mrays_per_s"], 0.0);
  }
}

TEST(Questions, AllHitsAreAnNpz) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  ASSERT_TRUE(succeeds(asking.run({"--rays", asking.doubles, "--all-hits", "--repeat", "2"}, "a.npz")));
  auto files = files_of_npz(asking.folder.get("a.npz"));
  ASSERT_EQ(files.size(), 7u);
  EXPECT_EQ(values_of<std::uint64_t>(files.at("splits"), "'<u8'"),
            (std::vector<std::uint64_t>{0, 2, 4, 5, 5, 5}));
  EXPECT_EQ(values_of<double>(files.at("t"), "'<f8'"), (std::vector<double>{2, 2.5, 4, 5, 0.75}));
  EXPECT_EQ(values_of<std::uint32_t>(files.at("geometry"), "'<u4'"), std::vector<std::uint32_t>(5, 0));
  std::vector<std::uint32_t> faces;
  for (const std::uint32_t primitive : values_of<std::uint32_t>(files.at("primitive"), "'<u4'"))
    faces.push_back(primitive / 2);
  EXPECT_EQ(faces, (std::vector<std::uint32_t>{1, 0, 1, 0, 0}));
  EXPECT_EQ(values_of<float>(files.at("u"), "'<f4'").size(), 5u);
  EXPECT_EQ(values_of<float>(files.at("v"), "'<f4'").size(), 5u);
  EXPECT_EQ(values_of<std::uint8_t>(files.at("more"), "'|b1'"), std::vector<std::uint8_t>(5, 0));

  ASSERT_TRUE(succeeds(asking.run({"--rays", asking.floats, "--all-hits", "--max-hits", "1"}, "a.npz")));
  files = files_of_npz(asking.folder.get("a.npz"));
  EXPECT_EQ(values_of<double>(files.at("t"), "'<f8'"), (std::vector<double>{2, 4, 0.75}));
  EXPECT_EQ(values_of<std::uint8_t>(files.at("more"), "'|b1'"), (std::vector<std::uint8_t>{1, 1, 0, 0, 0}));
}

// Two boxes side by side, kept as instances: the rays of Asking meet the second alone.
TEST(Questions, HitsTellInstancesThatAreKept) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  const fs::path scene =
      asking.folder.put("s.json", R"({"objects": [{"type": "mesh", "file": "box.obj", "instances": [
          {"translate": [7, 0, 0]}, {"translate": [0, 0, 0]}]}]})");
  const auto run = [&](const fs::path& rays, std::vector<std::string> more) {
    std::vector<std::string> all = {"trace",  scene, "--instances", "kept",
                                    "--rays", rays,  "-o",          asking.folder / "h.npz"};
    all.insert(all.end(), more.begin(), more.end());
    return kdray(all);
  };
  const std::vector<std::int32_t> second = {1, 1, 1, -1, -1};
  for (const fs::path& rays : {asking.floats, asking.doubles}) {
    ASSERT_TRUE(succeeds(run(rays, {})));
    const auto files = files_of_npz(asking.folder.get("h.npz"));
    ASSERT_EQ(files.size(), 5u);
    EXPECT_EQ(values_of<std::int32_t>(files.at("instance"), "'<i4'"), second);
    EXPECT_EQ(values_of<std::int32_t>(files.at("primitive"), "'<i4'").at(0) / 2, 1);
  }
  for (const char* const walk : {"wide", "packet", "batch"}) {
    ASSERT_TRUE(succeeds(run(asking.floats, {"--traversal", walk})));
    const auto files = files_of_npz(asking.folder.get("h.npz"));
    EXPECT_EQ(values_of<std::int32_t>(files.at("instance"), "'<i4'"), second) << walk;
  }
  ASSERT_TRUE(succeeds(run(asking.doubles, {"--all-hits"})));
  const auto files = files_of_npz(asking.folder.get("h.npz"));
  EXPECT_EQ(values_of<std::int32_t>(files.at("instance"), "'<i4'"), std::vector<std::int32_t>(5, 1));
  const fs::path points =
      asking.folder.put("p.npy", npy_of("<f8", std::vector<std::array<double, 3>>{{0.5, 0.5, 0.5}}));
  std::vector<std::string> nearest = {"trace",           scene,  "--instances", "kept",
                                      "--closest-point", points, "-o",          asking.folder / "n.npy"};
  EXPECT_TRUE(fails_with(kdray(nearest), 2, "instances flat"));
  EXPECT_TRUE(fails_with(run(asking.floats, {"--traversal", "binary"}), 2, "instances flat"));
}

TEST(Questions, AllHitsGoToStdoutAsDash) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  ASSERT_TRUE(succeeds(asking.run({"--rays", asking.doubles, "--all-hits"}, "a.npz")));
  const Outcome run = kdray({"trace", asking.scene, "--rays", asking.doubles, "--all-hits", "-o", "-"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_EQ(run.out, asking.folder.get("a.npz"));
}

struct __attribute__((packed)) ClosestRow {
  double distance, point[3];
  std::uint32_t geometry, primitive;
  float u, v;
};
static_assert(sizeof(ClosestRow) == 48);

TEST(Questions, PointsAreAskedAsFloatsAndAsDoubles) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  const auto doubles = asking.folder.put(
      "p8.npy",
      npy_of("<f8", std::vector<std::array<double, 3>>{{0.5, 0.25, 0.125}, {0.25, 0.5, 3}, {4, 5, 1}}));
  const auto floats = asking.folder.put(
      "p4.npy",
      npy_of("<f4", std::vector<std::array<float, 3>>{{0.5f, 0.25f, 0.125f}, {0.25f, 0.5f, 3}, {4, 5, 1}}));
  const std::vector<double> distances = {0.125, 2, 5};
  for (const fs::path& points : {doubles, floats}) {
    ASSERT_TRUE(succeeds(asking.run({"--closest-point", points}, "p.npy")));
    const auto rows = values_of<ClosestRow>(
        asking.folder.get("p.npy"),
        "[('distance', '<f8'), ('point', '<f8', (3,)), ('geometry', '<u4'), ('primitive', '<u4'), "
        "('u', '<f4'), ('v', '<f4')]");
    ASSERT_EQ(rows.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(double{rows[i].distance}, distances[i]) << i;
    const double nearest[3][3] = {{0.5, 0.25, 0}, {0.25, 0.5, 1}, {1, 1, 1}};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(double{rows[i].point[k]}, nearest[i][k]) << i;
    EXPECT_EQ(rows[0].primitive / 2, 0u);
    EXPECT_EQ(rows[1].primitive / 2, 1u);

    ASSERT_TRUE(succeeds(asking.run({"--closest-point", points}, "p.npz")));
    const auto files = files_of_npz(asking.folder.get("p.npz"));
    EXPECT_EQ(values_of<double>(files.at("distance"), "'<f8'"), distances);
    EXPECT_EQ(values_of<double>(files.at("point"), "'shape': (3, 3)").at(6), 1.0);

    ASSERT_TRUE(succeeds(asking.run({"--signed-distance", points}, "s.npy")));
    EXPECT_EQ(values_of<double>(asking.folder.get("s.npy"), "'<f8'"), (std::vector<double>{-0.125, 2, 5}));
    const Outcome inside = asking.run({"--inside", points}, "i.npy");
    ASSERT_TRUE(succeeds(inside));
    EXPECT_NE(inside.err.find("1 of 3 points inside"), std::string::npos) << inside.err;
    EXPECT_EQ(values_of<std::uint8_t>(asking.folder.get("i.npy"), "'|b1'"),
              (std::vector<std::uint8_t>{1, 0, 0}));
  }
}

TEST(Questions, NothingAskedIsNothingAnswered) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  const auto rays = asking.folder.put("none.npy", npy_of("<f8", std::vector<BoxRay<double>>()));
  const auto points = asking.folder.put("no_points.npy", npy_of("<f4", std::vector<std::array<float, 3>>()));
  ASSERT_TRUE(succeeds(asking.run({"--rays", rays}, "h.npy")));
  EXPECT_TRUE(values_of<char>(asking.folder.get("h.npy"), "'shape': (0,)").empty());
  ASSERT_TRUE(succeeds(asking.run({"--rays", rays, "--count"}, "c.npy")));
  EXPECT_TRUE(values_of<char>(asking.folder.get("c.npy"), "'shape': (0,)").empty());
  ASSERT_TRUE(succeeds(asking.run({"--rays", rays, "--all-hits"}, "a.npz")));
  EXPECT_EQ(values_of<std::uint64_t>(files_of_npz(asking.folder.get("a.npz")).at("splits"), "(1,)"),
            std::vector<std::uint64_t>{0});
  for (const std::string question : {"--closest-point", "--signed-distance", "--inside"}) {
    ASSERT_TRUE(succeeds(asking.run({question, points}, "p.npy"))) << question;
    EXPECT_TRUE(values_of<char>(asking.folder.get("p.npy"), "'shape': (0,)").empty());
  }
}

TEST(Questions, WhatMeansNothingIsNamedAndLeavesNothing) {
  KDRAY_NEED_DEVICE();
  const Asking asking;
  auto rays = box_rays<double>();
  rays[3][1] = NAN;
  const auto bad = asking.folder.put("bad.npy", npy_of("<f8", rays));
  for (const std::string option : {"", "--any-hit", "--count", "--all-hits"}) {
    std::vector<std::string> arguments = {"--rays", bad};
    if (!option.empty()) arguments.push_back(option);
    EXPECT_TRUE(fails_with(asking.run(arguments, "x.npz"), 1, bad.string() + ": ray 3")) << option;
  }
  const auto points = asking.folder.put(
      "bad_points.npy", npy_of("<f8", std::vector<std::array<double, 3>>{{0, 0, 0}, {0, kEver, 0}}));
  for (const std::string option : {"--closest-point", "--signed-distance", "--inside"})
    EXPECT_TRUE(fails_with(asking.run({option, points}, "x.npz"), 1, points.string() + ": point 1"));
  EXPECT_FALSE(fs::exists(asking.folder / "x.npz"));
  EXPECT_EQ(asking.folder.n_entries(), 5u) << "a temporary is left";
}

TEST(Questions, FilesOfOtherShapesAreRefused) {
  const Asking asking;
  EXPECT_TRUE(fails_with(asking.run({"--inside", asking.doubles}, "x.npy"), 1, "points are N x 3"));
  const auto points =
      asking.folder.put("p.npy", npy_of("<f8", std::vector<std::array<double, 3>>{{0, 0, 0}}));
  EXPECT_TRUE(fails_with(asking.run({"--rays", points, "--count"}, "x.npy"), 1, "rays are N x 8"));
  const auto turned = asking.folder.put(
      "t.npy", npy("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", std::string(48, '\0')));
  EXPECT_TRUE(fails_with(asking.run({"--inside", turned}, "x.npy"), 1, "ascontiguousarray(points)"));
  EXPECT_FALSE(fs::exists(asking.folder / "x.npy"));
}

TEST(Questions, OptionsThatContradictEachOtherAreUsage) {
  const Asking asking;
  const std::string r4 = asking.floats, r8 = asking.doubles, p = r8;
  struct Case {
    std::vector<std::string> arguments;
    std::string output, said;
  };
  const Case cases[] = {
      {{}, "x.npy", "--rays is required"},
      {{"--rays", r4, "--count", "--any-hit"}, "x.npy", "--any-hit and --count ask different things"},
      {{"--rays", r4, "--all-hits", "--count"}, "x.npz", "--all-hits and --count"},
      {{"--inside", p, "--closest-point", p}, "x.npy", "--closest-point and --inside"},
      {{"--rays", r4, "--inside", p}, "x.npy", "leave --rays out"},
      {{"--rays", r4, "--max-hits", "3"}, "x.npy", "--max-hits is for --all-hits"},
      {{"--rays", r4, "--all-hits", "--max-hits", "0"}, "x.npz", "from 1"},
      {{"--rays", r4, "--all-hits"}, "x.npy", "ends in .npz"},
      {{"--rays", r4, "--count", "--traversal", "binary"}, "x.npy", "--traversal"},
      {{"--rays", r8, "--count", "--precision", "double"}, "x.npy", "--precision double"},
      {{"--closest-point", p, "--traversal", "wide"}, "x.npy", "a walk of its own"},
      {{"--rays", r8, "--geometry", "double", "--traversal", "wide"}, "x.npy", "leave --traversal and"},
      {{"--rays", r8, "--geometry", "double", "--precision", "double"}, "x.npy", "--precision out"},
      {{"--inside", asking.scene}, "box.obj", "the same file"},
  };
  for (const Case& c : cases) {
    EXPECT_TRUE(fails_with(asking.run(c.arguments, c.output), 2, c.said)) << c.said;
    EXPECT_FALSE(fs::exists(asking.folder / "x.npy"));
  }
}

}  // namespace
}  // namespace kdray::test
