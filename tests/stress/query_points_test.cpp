// inside() against the exact winding number, and signed_distance() against exact distances, for ten closed
// meshes at all scales and places. In full 1e7 and 1e5 points.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "accel/prepare/prepared.h"
#include "stress/lines.h"
#include "stress/table.h"
#include "stress/traced.h"
#include "stress/triangle_distance.h"
#include "stress/winding.h"
#include "support/device.h"

namespace kdray::stress {
namespace {

using Rational = mpq_class;

constexpr std::uint64_t kSeed = 12;
constexpr double kInsideShare = 0.01, kDistanceShare = 1e-4;  // of the suite's rays
// inside() rounds the point and each vertex to floats of the scene's own space (3u of the largest extent
// together), displaces corners by 5u and settles signs within 20u of their distances, which are up to 1.8
// extents (docs/design/queries.md): 18u and 35u. Together that is below 64u.
constexpr double kTooNear = 0x1p-18;

using MakePoint = dvec3 (*)(const ClosedShape&, Random&);

dvec3 around(const ClosedShape& shape, Random& random) {
  const dvec3 p(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6));
  return shape.center() + p * (shape.hi - shape.lo);
}
dvec3 near_the_surface(const ClosedShape& shape, Random& random) {
  const std::size_t t = random.below(shape.triangles.size());
  const dvec3 w = random.weights();
  const dvec3 on = w.x * shape.corner(t, 0) + w.y * shape.corner(t, 1) + w.z * shape.corner(t, 2);
  return on + random.direction() * (random.log_uniform(1e-7, 0.3) * shape.extent());
}
dvec3 near_corners_and_edges(const ClosedShape& shape, Random& random) {
  const dvec3 at = random.below(2) ? some_corner(shape, random) : some_edge_point(shape, random);
  return at + random.direction() * (random.log_uniform(1e-12, 0.3) * shape.extent());
}
dvec3 on_the_grid_of_vertices(const ClosedShape& shape, Random& random) {
  return {some_corner(shape, random).x, some_corner(shape, random).y, some_edge_point(shape, random).z};
}
dvec3 far_away(const ClosedShape& shape, Random& random) {
  return shape.center() + random.direction() * (random.log_uniform(1, 1e6) * shape.extent());
}

struct PointFamily {
  const char* name;
  MakePoint make;
};
constexpr std::array<PointFamily, 5> kPointFamilies{{{"around the mesh", around},
                                                     {"near the surface", near_the_surface},
                                                     {"near vertices and edges", near_corners_and_edges},
                                                     {"on the grid of vertices", on_the_grid_of_vertices},
                                                     {"far away", far_away}}};

std::vector<dvec3> make_points(const ClosedShape& shape, const PointFamily& family, std::uint64_t first,
                               std::size_t n) {
  std::vector<dvec3> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    Random random(kSeed, first + i);
    points[i] = family.make(shape, random);
  }
  return points;
}

std::size_t share_of_each(double share) {
  const auto n = static_cast<double>(n_placed() * kPointFamilies.size());
  return static_cast<std::size_t>(std::max(16.0, static_cast<double>(rays_to_trace(1)) * share / n));
}

// From the mesh as the program gave it.
double distance_from(const ClosedShape& shape, std::size_t triangle, const dvec3& point) {
  const auto corner = [&](std::size_t k) { return as<long double>(shape.corner(triangle, k) - point); };
  return static_cast<double>(std::sqrt(square_to_triangle(corner(0), corner(1), corner(2))));
}

double distance_from(const ClosedShape& shape, const dvec3& point) {
  double least = HUGE_VAL;
  for (std::size_t t = 0; t < shape.triangles.size(); ++t)
    least = std::min(least, distance_from(shape, t, point));
  return least;
}

bool is_too_near(const ClosedShape& shape, const dvec3& point) {
  const double limit = kTooNear * shape.extent();
  const dvec3 lo = point - limit, hi = point + limit;
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const dvec3 &a = shape.corner(t, 0), &b = shape.corner(t, 1), &c = shape.corner(t, 2);
    const dvec3 least = glm::min(a, glm::min(b, c)), most = glm::max(a, glm::max(b, c));
    if (glm::any(glm::greaterThan(least, hi)) || glm::any(glm::lessThan(most, lo))) continue;
    if (distance_from(shape, t, point) <= limit) return true;
  }
  return false;
}

class PointsOf : public testing::Test {
 protected:
  void SetUp() override {
    if (test::usable_devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

// Whether each edge is run through as often one way as the other, so that solid angles add up.
bool is_oriented(const ClosedShape& shape) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  for (const auto& t : shape.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      ways[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  return std::all_of(ways.begin(), ways.end(), [](const auto& way) { return way.second == 0; });
}

TEST(WindingNumber, IsThatOfSolidAngles) {
  int asked = 0;
  for (const ClosedShape& shape : ten_closed_shapes()) {
    if (!is_oriented(shape)) continue;
    ++asked;
    SCOPED_TRACE(shape.name);
    const Winding winding(shape);
    int inside = 0;
    for (const dvec3& p : make_points(shape, kPointFamilies[0], 0, 200)) {
      if (distance_from(shape, p) < 1e-6 * shape.extent()) continue;
      const int about = winding.about(p);
      EXPECT_NEAR(winding_by_angles(shape, p), about, 1e-6) << p.x << ' ' << p.y << ' ' << p.z;
      inside += about != 0;
    }
    EXPECT_GT(inside, 0);
  }
  EXPECT_EQ(asked, 8) << "cubes and slivers have faces that look either way";
}

TEST_F(PointsOf, ClosedMeshesAreInsideByTheWindingNumber) {
  const std::size_t n = share_of_each(kInsideShare);
  std::vector<Row> rows;
  for (const PointFamily& family : kPointFamilies) rows.push_back({"inside", family.name, "inside"});
  for_each_placed([&](std::uint64_t number, const Place& place, const ClosedShape& shape) {
    SCOPED_TRACE(shape.name + ", " + in_words(place));
    const Scene scene = committed(shape);
    const Winding winding(shape);
    for (std::size_t f = 0; f < kPointFamilies.size(); ++f) {
      const std::vector<dvec3> points = make_points(shape, kPointFamilies[f], number << 32, n);
      std::vector<std::uint8_t> inside(n);
      scene.inside(points_of(points), inside);
      std::atomic<std::uint64_t> wrong{0}, excepted{0};
      tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
        if ((winding.about(points[i]) % 2 != 0) == (inside[i] == 1)) return;
        if (is_too_near(shape, points[i])) {
          ++excepted;
        } else if (wrong++ < 3) {
          const dvec3& p = points[i];
          ADD_FAILURE() << kPointFamilies[f].name << ", seed " << kSeed << ", point " << i << ", " << p.x
                        << ' ' << p.y << ' ' << p.z << ": " << int{inside[i]} << ", "
                        << distance_from(shape, p) / shape.extent() << " of the extent from the surface";
        }
      });
      rows[f].rays += n, rows[f].wrong += wrong, rows[f].exceptions += excepted;
    }
  });
  for (const Row& row : rows) add(row);
}

// A committed mesh as kdray has it: floats in a space of its own, which are taken as exact.
class StoredMesh {
 public:
  explicit StoredMesh(const Scene& scene)
      : prepared_(scene.prepared()), space_(prepared_.prepared().geometry.space) {}

  const LocalSpace& space() const { return space_; }
  // How far the point is moved by being rounded in that space: within the mesh's bounds hardly ever.
  double rounding_of(const dvec3& point) const {
    const Coordinates<Rational> exact = local(point), rounded = as<Rational>(space_.local(point));
    Rational sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += abs(exact[k] - rounded[k]);
    return space_.world_length(sum.get_d());
  }

  // The square of the distance, in the world's lengths; exactly.
  Rational square_distance(const dvec3& point) const {
    const Coordinates<long double> rough = as<long double>(space_.local(point));
    std::vector<long double> squares;
    for (const layout::Triangle& t : triangles()) squares.push_back(square_from(rough, t));
    const long double least = *std::min_element(squares.begin(), squares.end());
    // Long doubles have 64 bits of differences that the doubles before them round to 53.
    const long double off = 0x1p-48L * (largest_component(space_.local(point)) + 0x1p11L);
    const long double limit = (std::sqrt(least) + off) * (std::sqrt(least) + off);
    const Coordinates<Rational> p = local(point);
    std::optional<Rational> square;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      if (squares[i] > limit) continue;
      const Rational exact = square_from(p, triangles()[i]);
      if (!square || exact < *square) square = exact;
    }
    return *square / space_.scale / space_.scale;
  }

 private:
  std::span<const layout::Triangle> triangles() const { return prepared_.prepared().flat.triangles; }

  Coordinates<Rational> local(const dvec3& point) const {
    Coordinates<Rational> p = minus(as<Rational>(point), as<Rational>(space_.center));
    for (Rational& x : p) x *= space_.scale;
    return p;
  }

  template <class N>
  static N square_from(const Coordinates<N>& p, const layout::Triangle& t) {
    const auto corner = [&](const float(&v)[3]) {
      return minus(Coordinates<N>{N(v[0]), N(v[1]), N(v[2])}, p);
    };
    return square_to_triangle(corner(t.v[0]), corner(t.v[1]), corner(t.v[2]));
  }

  PreparedScene prepared_;
  LocalSpace space_;
};

// Errors of distances against the exact ones.
struct DistanceErrors {
  std::uint64_t n = 0, within_half = 0, within_4 = 0, within_16 = 0;  // in ulps of a double
  double most_double_ulps = 0, most_float_ulps = 0;

  void add(double error, double distance) {
    const double ulp_of_double = std::ldexp(1.0, std::ilogb(distance) - 52), ulps = error / ulp_of_double;
    ++n;
    within_half += ulps <= 0.5, within_4 += ulps <= 4, within_16 += ulps <= 16;
    most_double_ulps = std::max(most_double_ulps, ulps);
    most_float_ulps = std::max(most_float_ulps, ulps * 0x1p-29);
  }
};

double error_of(double distance, const Rational& square) {
  const mpf_class exact(square, 1024), root = sqrt(exact);
  return std::abs(mpf_class(distance - root).get_d());
}

// Whether it is at most so far from the root of the square: exactly.
bool is_within(double distance, const Rational& square, const Rational& allowed) {
  const Rational below = Rational(distance) - allowed, above = Rational(distance) + allowed;
  return (below <= 0 || below * below <= square) && square <= above * above;
}

TEST_F(PointsOf, SignedDistancesAreExactToFourUlpsOfAFloat) {
  const std::size_t n = share_of_each(kDistanceShare);
  std::vector<Row> rows;
  for (const PointFamily& family : kPointFamilies) rows.push_back({"distance", family.name, "signed"});
  std::array<DistanceErrors, kPointFamilies.size()> errors;
  std::mutex mutex;
  for_each_placed([&](std::uint64_t number, const Place& place, const ClosedShape& shape) {
    SCOPED_TRACE(shape.name + ", " + in_words(place));
    const Scene scene = committed(shape);
    const StoredMesh mesh(scene);
    const Winding winding(shape);
    for (std::size_t f = 0; f < kPointFamilies.size(); ++f) {
      const std::vector<dvec3> points = make_points(shape, kPointFamilies[f], (number << 32) + 7777, n);
      std::vector<double> distances(n);
      scene.signed_distance(points_of(points), distances);
      tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
        const double distance = std::abs(distances[i]);
        const Rational square = mesh.square_distance(points[i]);
        const double rounding = mesh.rounding_of(points[i]), error = error_of(distance, square);
        const Rational allowed = Rational(4 * 0x1p-24 * distance) + rounding;
        const bool right = is_within(distance, square, allowed);
        const bool signed_right = (winding.about(points[i]) % 2 != 0) == std::signbit(distances[i]) ||
                                  is_too_near(shape, points[i]);
        const std::lock_guard lock(mutex);
        // Where the point's own rounding is below what is asked of the answer.
        if (distance > 0 && rounding < 0x1p-56 * distance)
          errors[f].add(error, distance);
        else
          ++rows[f].exceptions;
        ++rows[f].rays;
        if (right && signed_right) return;
        if (rows[f].wrong++ < 3)
          ADD_FAILURE() << kPointFamilies[f].name << ", seed " << kSeed << ", point " << i << ": "
                        << distances[i] << " is off by " << error << (signed_right ? "" : ", wrong side");
      });
    }
  });
  for (const Row& row : rows) add(row);
  for (std::size_t f = 0; f < kPointFamilies.size(); ++f) {
    const DistanceErrors& e = errors[f];
    std::printf(
        "distances %-26s %8llu: within half an ulp of double %llu, 4 %llu, 16 %llu; most %.3g, of float's "
        "%.3g\n",
        kPointFamilies[f].name, static_cast<unsigned long long>(e.n),
        static_cast<unsigned long long>(e.within_half), static_cast<unsigned long long>(e.within_4),
        static_cast<unsigned long long>(e.within_16), e.most_double_ulps, e.most_float_ulps);
  }
}

}  // namespace
}  // namespace kdray::stress
