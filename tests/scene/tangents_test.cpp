// What    Tangents as they are packed, against themselves unpacked in double; those of a smooth ball, against
//         the parallels of latitude; and those of random meshes, against the definition by brute force.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scene/model/instances.h"
#include "scene/model/tangents.h"

namespace kdray::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr unsigned kSeed = 28;

TEST(Tangents, ArePackedInTwoNumbers) {
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> part;
  for (int i = 0; i < 10000; ++i) {
    dvec3 d = glm::normalize(dvec3(part(random), part(random), part(random)));
    if (i < 6) d = dvec3(0), d[i % 3] = i < 3 ? 1 : -1;
    const double hand = i % 2 ? 1 : -1;
    const auto packed = packed_tangent({d, hand});
    const Tangent t = unpacked_tangent(packed.data());
    ASSERT_LT(glm::length(t.direction - d), 1e-6);
    ASSERT_EQ(t.hand, hand);
  }
  for (const dvec3& none : {dvec3(0), dvec3(NAN, 0, 1), dvec3(INFINITY, 0, 0)}) {
    const auto packed = packed_tangent({none, -1});
    EXPECT_EQ(packed[0], 0);
    EXPECT_EQ(packed[1], 0);
    EXPECT_EQ(unpacked_tangent(packed.data()).direction, dvec3(0));
  }
}

void add_triangle(Scene& s, const std::array<dvec3, 3>& places, const std::array<vec3, 3>& normals,
                  const std::array<std::array<float, 2>, 3>& uv) {
  Triangle t;
  layout::TexCoords at{};
  for (std::size_t k = 0; k < 3; ++k) {
    t.vertex[k] = static_cast<std::uint32_t>(s.vertices.size());
    t.normal[k] = static_cast<std::uint32_t>(s.normals.size());
    s.vertices.push_back(places[k]);
    s.normals.push_back(normals[k]);
    at.uv[k][0] = uv[k][0], at.uv[k][1] = uv[k][1];
  }
  s.triangles.push_back(t);
  s.texturing.texcoords[0].push_back(at);
}

// Its picture goes round eastwards, with north at the top, or westwards.
Scene ball(bool westwards) {
  constexpr int kAround = 24, kUp = 12;
  Scene s;
  const auto at = [&](int i, int j, std::array<float, 2>& uv) {
    const double east = 2 * kPi * (i % kAround) / kAround, north = kPi * j / kUp - kPi / 2;
    uv = {static_cast<float>(westwards ? kAround - i : i) / kAround, 1 - static_cast<float>(j) / kUp};
    return dvec3(std::cos(north) * std::cos(east), std::cos(north) * std::sin(east), std::sin(north));
  };
  for (int j = 1; j + 2 < kUp; ++j)
    for (int i = 0; i < kAround; ++i) {
      std::array<std::array<float, 2>, 4> uv;
      const std::array<dvec3, 4> p = {at(i, j, uv[0]), at(i + 1, j, uv[1]), at(i + 1, j + 1, uv[2]),
                                      at(i, j + 1, uv[3])};
      for (const auto& f : {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 3}})
        add_triangle(s, {p[f[0]], p[f[1]], p[f[2]]}, {vec3(p[f[0]]), vec3(p[f[1]]), vec3(p[f[2]])},
                     {uv[f[0]], uv[f[1]], uv[f[2]]});
    }
  return s;
}

// Steps of 15 degrees. A triangle's own tangent, laid into the plane at a corner, is up to 7.5 degrees off
// the parallel there; from both sides together they are not. (Where the picture begins there is one side.)
TEST(SmoothTangents, OfABallAreItsParallels) {
  double worst = 1;
  for (const bool westwards : {false, true}) {
    Scene s = ball(westwards);
    smooth_tangents(s, 0, 0);
    ASSERT_EQ(s.texturing.tangents.size(), s.triangles.size());
    for (std::size_t i = 0; i < s.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const dvec3& p = s.vertices[s.triangles[i].vertex[k]];
        const bool seam = p.x > 0 && std::abs(p.y) < 1e-9;
        const dvec3 east = glm::normalize(dvec3(-p.y, p.x, 0));
        const Tangent t = unpacked_tangent(s.texturing.tangents[i].uv[k]);
        if (!seam) worst = std::min(worst, glm::dot(t.direction, westwards ? -east : east));
        ASSERT_EQ(t.hand, westwards ? -1 : 1);
      }
  }
  EXPECT_GT(worst, std::cos(1.5 * kPi / 180)) << std::acos(worst) * 180 / kPi << " degrees";
}

// All triangles, each corner against all others.
Tangent by_definition(const Scene& s, std::size_t triangle, std::size_t corner) {
  const auto place = [&](std::size_t i, std::size_t k) { return s.vertices[s.triangles[i].vertex[k]]; };
  const auto normal = [&](std::size_t i, std::size_t k) {
    return dvec3(s.normals[s.triangles[i].normal[k]]);
  };
  const auto uv = [&](std::size_t i, std::size_t k) {
    const auto& at = s.texturing.texcoords[0][i].uv[k];
    return glm::dvec2(at[0], at[1]);
  };
  const auto area = [&](std::size_t i) {
    const glm::dvec2 a = uv(i, 1) - uv(i, 0), b = uv(i, 2) - uv(i, 0);
    return a.x * b.y - a.y * b.x;
  };
  const dvec3 n = normal(triangle, corner);
  const auto flat = [&](const dvec3& v) { return v - n * glm::dot(n, v); };
  dvec3 sum(0);
  for (std::size_t i = 0; i < s.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      if (place(i, k) != place(triangle, corner) || normal(i, k) != n || uv(i, k) != uv(triangle, corner) ||
          (area(i) < 0) != (area(triangle) < 0))
        continue;
      // The column of the inverse Jacobian by which the first coordinate grows.
      const glm::dmat2 jacobian = glm::inverse(glm::dmat2(uv(i, 1) - uv(i, 0), uv(i, 2) - uv(i, 0)));
      const dvec3 own =
          (place(i, 1) - place(i, 0)) * jacobian[0][0] + (place(i, 2) - place(i, 0)) * jacobian[0][1];
      const dvec3 e = glm::normalize(flat(place(i, (k + 1) % 3) - place(i, k))),
                  f = glm::normalize(flat(place(i, (k + 2) % 3) - place(i, k)));
      sum += glm::normalize(flat(own)) * std::acos(std::clamp(glm::dot(e, f), -1.0, 1.0));
    }
  return {glm::normalize(sum), area(triangle) < 0 ? 1.0 : -1.0};
}

// A bumpy grid, some of whose vertices are torn apart by their normals or coordinates, with a picture that is
// mirrored on one half.
Scene grid(std::mt19937& random) {
  constexpr int kN = 6;
  std::uniform_real_distribution<double> part(-0.3, 0.3);
  std::array<std::array<dvec3, kN>, kN> places, normals;
  for (int y = 0; y < kN; ++y)
    for (int x = 0; x < kN; ++x) {
      places[y][x] = {x + part(random), y + part(random), part(random)};
      normals[y][x] = glm::normalize(dvec3(part(random), part(random), 1));
    }
  Scene s;
  for (int y = 0; y + 1 < kN; ++y)
    for (int x = 0; x + 1 < kN; ++x) {
      const double torn = (x + 3 * y) % 5 == 0 ? 1 : 0;
      const auto uv = [&](int i, int j) {
        return std::array<float, 2>{static_cast<float>(x < kN / 2 ? i : kN - i),
                                    static_cast<float>(-j - torn)};
      };
      const std::array<std::array<int, 2>, 4> at = {{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
      for (const auto& f : {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 3}}) {
        std::array<dvec3, 3> p;
        std::array<vec3, 3> n;
        std::array<std::array<float, 2>, 3> t;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto [i, j] = at[f[k]];
          p[k] = places[j][i], n[k] = vec3(normals[j][i]), t[k] = uv(i, j);
        }
        add_triangle(s, p, n, t);
      }
    }
  return s;
}

TEST(SmoothTangents, AreThoseOfTheirDefinition) {
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  for (int round = 0; round < 10; ++round) {
    Scene s = grid(random);
    smooth_tangents(s, 0, 0);
    for (std::size_t i = 0; i < s.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const Tangent wanted = by_definition(s, i, k), got = unpacked_tangent(s.texturing.tangents[i].uv[k]);
        ASSERT_LT(glm::length(got.direction - wanted.direction), 1e-5) << i << " " << k;
        ASSERT_EQ(got.hand, wanted.hand);
      }
  }
}

// Moving a scene and making its tangents can change places.
TEST(SmoothTangents, MoveWithTheirScene) {
  std::mt19937 random(kSeed);
  for (const dvec3& scale : {dvec3(1), dvec3(-2, 2, 2), dvec3(-3, -3, -3)}) {
    Scene before = grid(random), after = before;
    const dmat4 m = rotation(glm::normalize(dvec3(1, 2, 3)), 0.8) * scaling(scale);
    smooth_tangents(before, 0, 0);
    apply_transform(m, before);
    apply_transform(m, after);
    smooth_tangents(after, 0, 0);
    for (std::size_t i = 0; i < before.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const Tangent a = unpacked_tangent(before.texturing.tangents[i].uv[k]),
                      b = unpacked_tangent(after.texturing.tangents[i].uv[k]);
        ASSERT_LT(glm::length(a.direction - b.direction), 1e-5);
        ASSERT_EQ(a.hand, b.hand);
      }
  }
}

TEST(SmoothTangents, NeedAreaAndCoordinates) {
  Scene s;
  const std::array<vec3, 3> up{vec3(0, 0, 1), vec3(0, 0, 1), vec3(0, 0, 1)};
  add_triangle(s, {dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)}, up, {{{0, 0}, {0, 0}, {0, 0}}});
  add_triangle(s, {dvec3(0), dvec3(0), dvec3(0)}, up, {{{0, 0}, {1, 0}, {0, 1}}});
  add_triangle(s, {dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)}, {vec3(NAN), vec3(NAN), vec3(NAN)},
               {{{0, 0}, {1, 0}, {0, 1}}});
  smooth_tangents(s, 0, 0);
  ASSERT_EQ(s.texturing.tangents.size(), 3u);
  for (const layout::TexCoords& at : s.texturing.tangents)
    for (const auto& corner : at.uv) EXPECT_EQ(corner[1], 0);
}

}  // namespace
}  // namespace kdray::scene
