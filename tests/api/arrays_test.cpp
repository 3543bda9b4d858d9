// Views of a program's arrays (kdray/arrays.h): what they read, what they refuse, and that the way in which
// rows lie in memory changes no answer. Arrays lie in blocks of exactly their size: under the address
// sanitizer, none is read beyond its end.
#include "kdray/arrays.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>
#include <random>

#include "kdray/kdray.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/meshes.h"

namespace kdray {
namespace {

using test::fails;

TEST(Arrays, AStrideOfNoneIsNotOneOf0) {
  const std::vector<double> values = {1, 2, 3, 4, 5, 6};
  const Points packed(values.data(), 2), same(values.data(), 5, 0), of_range(values);
  EXPECT_EQ(packed[1], (std::array<double, 3>{4, 5, 6}));
  EXPECT_EQ(of_range[1], packed[1]);
  EXPECT_EQ(packed.stride(), 24u);
  EXPECT_EQ(same.size(), 5u);
  EXPECT_EQ(same[4], (std::array<double, 3>{1, 2, 3}));
}

TEST(Arrays, NoneReachesBeyondItsMemory) {
  const std::vector<float> values(12);
  const std::span<const float> memory(values);
  EXPECT_EQ(Points(memory, 4, 12).size(), 4u);
  EXPECT_EQ(Points(memory, 10, 4).size(), 10u) << "they overlap, and end where the memory does";
  EXPECT_EQ(Points(memory, std::size_t{1} << 40, 0).size(), std::size_t{1} << 40);
  EXPECT_EQ(Points(memory.subspan(9), 1, std::size_t{1} << 60).size(), 1u) << "one row has no stride";
  EXPECT_EQ(Points(std::span<const float>(), 0, 12).size(), 0u);
  EXPECT_TRUE(fails([&] { Points(memory, 5, 12); },
                    "5 rows of 12 bytes, 12 bytes apart, reach beyond the 48 bytes that there are"));
  EXPECT_TRUE(fails([&] { Points(memory, 11, 4); }, "beyond the 48 bytes"));
  EXPECT_TRUE(fails([&] { Points(memory.subspan(10), 1, 12); }, "beyond the 8 bytes"));
  EXPECT_TRUE(fails([&] { Points(memory, std::size_t{1} << 40, 1); }, "beyond"));
}

TEST(Arrays, PointersThatMeanNoMemoryAreRefused) {
  const std::vector<float> values(12);
  const float* const null = nullptr;
  EXPECT_EQ(Points(null, 0).size(), 0u);
  EXPECT_TRUE(fails([&] { Points(null, 1); }, "have no memory"));
  EXPECT_TRUE(fails([&] { Values(null, 2, 0); }, "have no memory"));
  const std::size_t backwards = static_cast<std::size_t>(-12), most = std::numeric_limits<std::size_t>::max();
  EXPECT_TRUE(fails([&] { Points(values.data() + 9, 4, backwards); }, "reach beyond any memory"));
  EXPECT_TRUE(fails([&] { Points(values.data(), most / 3 + 1, 12); }, "reach beyond any memory"))
      << "rows times bytes are 12 again";
}

TEST(Arrays, RowsToBeWrittenDontOverlap) {
  std::vector<float> values(12);
  EXPECT_EQ(PointsOut(values).size(), 4u);
  EXPECT_EQ(PointsOut(values.data(), 1, 0).size(), 1u);
  EXPECT_TRUE(fails([&] { PointsOut(values.data(), 2, 0); }, "are to be written and overlap"));
  EXPECT_TRUE(fails([&] { PointsOut(values.data(), 4, 8); }, "are to be written and overlap"));
}

// Rows somewhere in memory of its own, by a layout of chance, and the same rows one after the other.
template <class View, class T>
class Laid {
 public:
  // `values`: N for each of n rows. They need not be what is laid: rows may overlap, or be one.
  Laid(const std::vector<T>& values, std::size_t n, bool may_share, std::mt19937& random) : n_(n) {
    constexpr std::size_t kRow = View::kValues * sizeof(T);
    const std::size_t strides[] = {kRow, kRow + 1, kRow + sizeof(T), 3 * kRow + 5, 0, sizeof(T)};
    stride_ = strides[random() % (may_share ? 6 : 4)];
    memory_ = std::make_unique<std::byte[]>(bytes());
    for (std::size_t i = 0; i < n; ++i) std::memcpy(row(i), &values[i * View::kValues], kRow);
    packed_.resize(n * View::kValues);
    for (std::size_t i = 0; i < n; ++i) std::memcpy(&packed_[i * View::kValues], row(i), kRow);
  }
  View laid() const { return View(reinterpret_cast<const T*>(memory_.get()), n_, stride_); }
  View packed() const { return View(packed_.data(), n_); }

 private:
  std::size_t bytes() const { return (n_ - 1) * stride_ + View::kValues * sizeof(T); }
  std::byte* row(std::size_t i) const { return memory_.get() + i * stride_; }

  std::size_t n_, stride_;
  std::unique_ptr<std::byte[]> memory_;
  std::vector<T> packed_;
};

// The same arrays twice, each by chance of float or double.
class Both {
 public:
  explicit Both(unsigned seed) : random_(seed) {}

  template <class View>
  std::array<View, 2> operator()(std::size_t n, double least, double most, bool may_share = true) {
    return random_() % 2 == 0 ? of<View, float>(n, least, most, may_share)
                              : of<View, double>(n, least, most, may_share);
  }
  template <class View, class T>
  std::array<View, 2> of(std::size_t n, double least, double most, bool may_share = true) {
    std::uniform_real_distribution<double> within(least, most);
    std::vector<T> values(n * View::kValues);
    for (T& value : values) value = static_cast<T>(within(random_));
    return lay<View>(values, n, may_share);
  }
  template <class View, class T>
  std::array<View, 2> lay(const std::vector<T>& values, std::size_t n, bool may_share) {
    const auto both = std::make_shared<Laid<View, T>>(values, n, may_share, random_);
    kept_.push_back(both);
    return {both->laid(), both->packed()};
  }

 private:
  std::mt19937 random_;
  std::vector<std::shared_ptr<void>> kept_;
};

struct EveryAnswer {
  std::vector<double> t, u, v, normal, point, distance, nearest, to_surface;
  std::vector<std::uint32_t> geometry, primitive, instance, counts, all_primitive, near_primitive;
  std::vector<std::uint64_t> splits;
  std::vector<double> all_t;
  std::vector<std::uint8_t> any, inside;
  bool operator==(const EveryAnswer&) const = default;
};

void ask_of_rays(const Scene& scene, const Rays& rays, EveryAnswer& a) {
  const std::size_t n = rays.directions.size();
  for (auto* doubles : {&a.t, &a.u, &a.v}) doubles->resize(n);
  for (auto* words : {&a.geometry, &a.primitive, &a.instance, &a.counts}) words->resize(n);
  a.normal.resize(3 * n), a.point.resize(3 * n), a.any.resize(n);
  const QueryOptions options{.invalid = InvalidRays::miss};
  scene.closest(rays, {a.t, a.geometry, a.primitive, a.u, a.v, a.normal, a.point, a.instance}, options);
  scene.any(rays, a.any, options);
  scene.count(rays, a.counts, options);
  AllHits all = scene.all(rays, AllHitsOptions{options});
  a.splits = all.splits, a.all_t = all.t, a.all_primitive = all.primitive;
}

void ask_of_points(const Scene& scene, const Points& points, EveryAnswer& a) {
  const std::size_t n = points.size();
  a.distance.resize(n), a.to_surface.resize(n), a.nearest.resize(3 * n);
  a.near_primitive.resize(n), a.inside.resize(n);
  scene.closest_points(points, {.distance = a.distance, .point = a.nearest, .primitive = a.near_primitive});
  scene.inside(points, a.inside);
  scene.signed_distance(points, a.to_surface);
}

class Layouts : public test::EachDevice {};
KDRAY_FOR_EACH_DEVICE(Layouts);

TEST_P(Layouts, ChangeNoAnswer) {
  CommitOptions commit;
  commit.device.device = GetParam();
  std::size_t n_hits = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Both both(seed);
    const std::size_t n = 1 + seed * 37 % 90;
    const auto vertices = both.operator()<Points>(n + 2, -2, 2, false),
               moved = both.operator()<Points>(n + 2, -2, 2),
               normals = both.operator()<Points>(n + 2, 0.1, 1), centers = both.operator()<Points>(n, -3, 3),
               axes = both.operator()<Points>(n, 0.1, 1), apexes = both.operator()<Points>(n, 4, 5);
    const auto radii = both.operator()<Values>(n, 0.1, 0.5), thin = both.operator()<Values>(n, 0.01, 0.05);
    const auto coordinates = both.operator()<Pairs>(n + 2, 0, 1);
    std::vector<std::int64_t> corners;
    for (std::size_t i = 0; i < 3 * n; ++i)
      corners.push_back(static_cast<std::int64_t>((i * 7 + i / 3) % (n + 2)));
    const auto triangles = both.lay<Triples>(corners, n, true);
    std::vector<double> places;
    for (std::size_t i = 0; i < n; ++i)
      for (const double x : {1., 0., 0., 6. + static_cast<double>(i), 0., 1., 0., 0., 0., 0., 1., 0.})
        places.push_back(x);
    const auto transforms = both.lay<Transforms>(places, n, false);
    const auto materials = both.lay<Words>(std::vector<std::uint32_t>(n, 0), n, true);
    const auto origins = both.operator()<Points>(n, -4, 4), directions = both.operator()<Points>(n, -1, 1),
               points = both.operator()<Points>(n, -3, 3);
    const auto t_min = both.operator()<Values>(n, 0, 0.5), t_max = both.operator()<Values>(n, 2, 50);
    std::vector<std::uint32_t> bits;
    for (std::size_t i = 0; i < n; ++i) bits.push_back(static_cast<std::uint32_t>(i % 4));
    const auto masks = both.lay<Words>(bits, n, true);

    EveryAnswer found[2];
    for (std::size_t k = 0; k < 2; ++k) {
      Scene scene;
      const GeometryId mesh = scene.add_mesh({vertices[k], triangles[k], normals[k], coordinates[k]});
      scene.add_spheres({centers[k], radii[k]}, {.mask = 1});
      scene.add_cones({centers[k], apexes[k], radii[k], thin[k]}, {.mask = 2});
      scene.add_discs({centers[k], axes[k], radii[k]});
      scene.add_tori({centers[k], axes[k], radii[k], thin[k]});
      const GeometryId prototype = scene.add_spheres({centers[k], thin[k]}, {.prototype = true});
      const GeometryId instances = scene.add_instances(prototype, transforms[k], {.materials = materials[k]});
      scene.update_vertices(mesh, moved[k], normals[k]);
      scene.update_transforms(instances, transforms[k]);
      scene.commit(commit);
      ask_of_rays(scene, {origins[k], directions[k], t_min[k], t_max[k], masks[k]}, found[k]);
      scene.enable(instances, false);  // points can't be asked of them
      scene.commit(commit);
      ask_of_points(scene, points[k], found[k]);
    }
    EXPECT_TRUE(found[0] == found[1]);
    n_hits += found[0].all_t.size();
  }
  EXPECT_GT(n_hits, 100u);
}

// Floats without gaps, as nearly all rays are, go another way than those of the test above.
TEST_P(Layouts, OneRowForAllRaysIsReadAlone) {
  const test::Cube cube;
  CommitOptions commit;
  commit.device.device = GetParam();
  Scene scene;
  scene.add_mesh({cube.vertices, cube.triangles});
  scene.commit(commit);
  const std::size_t n = 100'000;
  const std::unique_ptr<float[]> eye(new float[3]{0, 0, 6}), down(new float[3]{0, 0, -1});
  const std::unique_ptr<double[]> far_eye(new double[3]{0, 0, 7}), limit(new double[1]{9});
  std::vector<float> t(n);
  scene.closest({Points(eye.get(), n, 0), Points(down.get(), n, 0)}, {.t = t});
  EXPECT_EQ(t, std::vector<float>(n, 5));
  scene.closest({Points(far_eye.get(), n, 0), Points(down.get(), 1), {}, Values(limit.get(), n, 0)},
                {.t = t});
  EXPECT_EQ(t, std::vector<float>(n, 6));
  std::vector<float> distance(n);
  scene.signed_distance(Points(eye.get(), n, 0), distance);
  EXPECT_EQ(distance, std::vector<float>(n, 5));
}

TEST_P(Layouts, WeightsMayBePairs) {
  const test::Cube cube;
  CommitOptions commit;
  commit.device.device = GetParam();
  Scene scene;
  scene.add_mesh({cube.vertices, cube.triangles});
  scene.commit(commit);
  const std::size_t n = 1003;  // no multiple of four
  std::vector<std::array<float, 3>> eyes(n), down(n, {0, 0, -1});
  for (std::size_t i = 0; i < n; ++i)
    eyes[i] = {static_cast<float>(i % 37) / 16 - 1.1f, static_cast<float>(i % 41) / 20 - 1, 6};
  const Rays rays{Points(&eyes[0][0], n, sizeof eyes[0]), Points(&down[0][0], n, sizeof down[0])};
  std::vector<float> u(n), v(n), pairs(2 * n + 1, -7);
  scene.closest(rays, {.u = u, .v = v});
  scene.closest(rays, {.u = {pairs.data(), n, 2 * sizeof(float)}, .v = {&pairs[1], n, 2 * sizeof(float)}});
  std::size_t n_hits = 0;
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(pairs[2 * i], u[i]) << i;
    ASSERT_EQ(pairs[2 * i + 1], v[i]) << i;
    n_hits += u[i] > 0 && v[i] > 0;
  }
  EXPECT_GT(n_hits, 100u);
  EXPECT_EQ(pairs[2 * n], -7) << "behind the last row";
}

}  // namespace
}  // namespace kdray
