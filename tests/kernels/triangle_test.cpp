// The triangle test: nothing escapes from closed meshes at edges and vertices, and a ray never hits what it
// starts on. (The full stress suites are elsewhere; these are the method's own tests.)
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "base/vec.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

struct Case {
  float origin[3], direction[3];
  float v[3][3];
};
struct Found {
  int hit;
  float t, u, v;
};

// -DZERO_AREA=true: the triangles have no area.
const char* const kSource =
    "#include \"primitives/triangle/intersect.clh\"\n"
    "typedef struct Case { float origin[3], direction[3]; float v[3][3]; } Case;\n"
    "typedef struct Found { int hit; float t, u, v; } Found;\n"
    "__kernel void test(__global const Case* in, __global Found* out, uint n) {\n"
    "  const uint i = get_global_id(0);\n"
    "  if (i >= n) return;\n"
    "  Found f = {0, 0, 0, 0};\n"
    "  f.hit = intersect_triangle(make_shear(load3(in[i].direction)), load3(in[i].origin), "
    "load3(in[i].direction), &in[i].v[0][0], "
    "ZERO_AREA, &f.t,\n"
    "                             &f.u, &f.v);\n"
    "  out[i] = f;\n"
    "}\n";

void set(float (&out)[3], const vec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}

Case make_case(const vec3& o, const vec3& d, const std::array<vec3, 3>& triangle) {
  Case c;
  set(c.origin, o);
  set(c.direction, d);
  for (std::size_t k = 0; k < 3; ++k) set(c.v[k], triangle[k]);
  return c;
}

// The 8 faces of a random octahedron around the origin: closed, every edge shared by two, every vertex by
// four.
std::vector<std::array<vec3, 3>> octahedron(std::mt19937& random) {
  std::uniform_real_distribution<float> length(0.1f, 10), bend(-0.2f, 0.2f);
  std::array<vec3, 6> v;
  for (int k = 0; k < 6; ++k) {
    v[static_cast<std::size_t>(k)] = vec3(bend(random), bend(random), bend(random));
    v[static_cast<std::size_t>(k)][k / 2] = (k % 2 ? -1.0f : 1.0f) * length(random);
  }
  std::vector<std::array<vec3, 3>> faces;
  for (std::size_t x : {0u, 1u})
    for (std::size_t y : {2u, 3u})
      for (std::size_t z : {4u, 5u}) faces.push_back({v[x], v[y], v[z]});
  return faces;
}

class TriangleTest : public test::EachDevice {};

TEST_P(TriangleTest, NoRayEscapesAtAVertexOrAnEdge) {
  const unsigned seed = 3;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1), inner(-0.01f, 0.01f);
  std::vector<Case> in;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const auto faces = octahedron(random);
    const vec3 origin(inner(random), inner(random), inner(random));
    const auto& face = faces[static_cast<std::size_t>(i) % 8];
    const float s = i % 3 == 0 ? 0.0f : unit(random);  // a vertex, or a point of an edge
    const vec3 target = face[0] + s * (face[1] - face[0]);
    for (const auto& f : faces) in.push_back(make_case(origin, target - origin, f));
  }
  const std::vector<Found> out = test::run_kernel<Found>(GetParam(), kSource, in, "-DZERO_AREA=false");
  for (int i = 0; i < kRays; ++i) {
    // A face seen edge-on may put its hit anywhere along the edge; another face has it at the target.
    float nearest_error = INFINITY;
    for (int f = 0; f < 8; ++f) {
      const Found& found = out[static_cast<std::size_t>(i * 8 + f)];
      if (found.hit && found.t > 0) nearest_error = std::min(nearest_error, std::abs(found.t - 1));
    }
    ASSERT_LT(nearest_error, 1e-4f) << "ray " << i << " escapes";
  }
}

TEST_P(TriangleTest, ARayInThePlaneItStartsFromDoesNotHitIt) {
  const unsigned seed = 5;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-1000, 1000), unit(0, 1);
  std::vector<Case> in;
  for (int i = 0; i < 100000; ++i) {
    const int axis = i % 3;
    const float height = i % 2 ? 0.0f : coordinate(random);
    std::array<vec3, 3> triangle;
    for (vec3& v : triangle) {
      v = vec3(coordinate(random), coordinate(random), coordinate(random));
      v[axis] = height;
    }
    float s = unit(random), t = unit(random);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    vec3 origin = triangle[0] + s * (triangle[1] - triangle[0]) + t * (triangle[2] - triangle[0]);
    origin[axis] = height;
    vec3 direction(coordinate(random), coordinate(random), coordinate(random));
    if (i % 5 == 0) direction[axis] *= 1e-6f;  // grazing
    in.push_back(make_case(origin, direction, triangle));
  }
  const std::vector<Found> out = test::run_kernel<Found>(GetParam(), kSource, in, "-DZERO_AREA=false");
  int met = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    met += out[i].hit;
    ASSERT_FALSE(out[i].hit && out[i].t != 0.0f) << i << " t = " << out[i].t;
  }
  EXPECT_GT(met, 50000);  // the line does pass through the triangle: t = 0 exactly
}

TEST_P(TriangleTest, AgreesWithDoubleAwayFromEdges) {
  const unsigned seed = 9;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-1, 1);
  const auto point = [&] { return vec3(coordinate(random), coordinate(random), coordinate(random)); };
  std::vector<Case> in;
  for (int i = 0; i < 100000; ++i) in.push_back(make_case(point(), point(), {point(), point(), point()}));
  const std::vector<Found> out = test::run_kernel<Found>(GetParam(), kSource, in, "-DZERO_AREA=false");
  int compared = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto at = [](const float(&p)[3]) { return dvec3(p[0], p[1], p[2]); };
    // Moeller and Trumbore in double.
    const dvec3 a = at(in[i].v[0]), e1 = at(in[i].v[1]) - a, e2 = at(in[i].v[2]) - a, d = at(in[i].direction);
    const dvec3 p = glm::cross(d, e2), s = at(in[i].origin) - a, q = glm::cross(s, e1);
    const double det = glm::dot(e1, p);
    if (std::abs(det) < 1e-3) continue;
    const double u = glm::dot(s, p) / det, v = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
    const double margin = std::min({u, v, 1 - u - v});
    if (std::abs(margin) < 1e-3) continue;
    ++compared;
    ASSERT_EQ(out[i].hit != 0, margin > 0) << i;
    if (margin < 0) continue;
    EXPECT_NEAR(out[i].t, t, 1e-3 * std::max(1.0, std::abs(t))) << i;
    EXPECT_NEAR(out[i].u, u, 1e-3) << i;
    EXPECT_NEAR(out[i].v, v, 1e-3) << i;
  }
  EXPECT_GT(compared, 50000);
}

// ---- Zero-area triangles

// Three points of a grid on a line, in any order, and a place between the outer two.
struct ZeroAreaCase {
  std::array<vec3, 3> corners;
  vec3 place;
};

ZeroAreaCase make_zero_area(std::mt19937& random) {
  std::uniform_int_distribution<int> step(-9, 9), start(-500, 500);
  std::uniform_real_distribution<float> unit(0, 1);
  const vec3 first(start(random), start(random), start(random));
  vec3 way(0);
  while (way == vec3(0)) way = vec3(step(random), step(random), step(random));
  std::array<int, 3> at{0, 1 + static_cast<int>(random() % 30), 0};
  at[2] = at[1] + 1 + static_cast<int>(random() % 30);
  const vec3 place = first + unit(random) * static_cast<float>(at[2]) * way;
  std::shuffle(at.begin(), at.end(), random);
  ZeroAreaCase c{{}, place};
  for (std::size_t i = 0; i < 3; ++i) c.corners[i] = first + static_cast<float>(at[i]) * way;
  return c;
}

float largest(const vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// What the corners' projection may be off by, with room: 16 units of roundoff of their distance.
float in_doubt(const Case& c) {
  float reach = 0;
  for (const auto& v : c.v)
    reach = std::max(reach, largest(vec3(v[0] - c.origin[0], v[1] - c.origin[1], v[2] - c.origin[2])));
  return 16 * 0x1p-24f * reach;
}

TEST_P(TriangleTest, AZeroAreaTriangleIsHitOnItsLine) {
  const unsigned seed = 25;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-1000, 1000);
  std::vector<Case> in;
  for (int i = 0; i < 100000; ++i) {
    const ZeroAreaCase s = make_zero_area(random);
    const vec3 origin(coordinate(random), coordinate(random), coordinate(random));
    in.push_back(make_case(origin, s.place - origin, s.corners));
  }
  const auto out = test::run_kernel<Found>(GetParam(), kSource, in, "-DZERO_AREA=true");
  int hits = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!out[i].hit) continue;
    ++hits;
    const auto at = [](const float(&p)[3]) { return dvec3(p[0], p[1], p[2]); };
    const double u = out[i].u, v = out[i].v, w = 1 - u - v;
    ASSERT_TRUE(u >= 0 && v >= 0 && w > -1e-6) << i;
    const dvec3 hit = w * at(in[i].v[0]) + u * at(in[i].v[1]) + v * at(in[i].v[2]);
    const dvec3 seen = at(in[i].origin) + static_cast<double>(out[i].t) * at(in[i].direction);
    // Along the ray's largest axis the two agree but for the rounding of t.
    ASSERT_LT(glm::length(hit - seen), 2 * in_doubt(in[i])) << i << " t = " << out[i].t;
  }
  EXPECT_GT(hits, 1000) << "rays that corners rounded apart let through";
}

TEST_P(TriangleTest, ARayThatStartsAtAZeroAreaTriangleHasLeftIt) {
  const unsigned seed = 26;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto direction = [&] { return glm::normalize(vec3(unit(random), unit(random), unit(random))); };
  std::vector<Case> in;
  for (int i = 0; i < 400000; ++i) {
    const ZeroAreaCase s = make_zero_area(random);
    // The mean of the corners' distances is not below the least of them.
    const vec3 middle = 0.5f * s.corners[0] + 0.5f * s.corners[1];
    float least = INFINITY;
    for (const vec3& corner : s.corners) least = std::min(least, largest(corner - middle));
    const vec3 origin = middle + 8 * 0x1p-24f * least * direction();
    in.push_back(make_case(origin, direction(), s.corners));
  }
  const auto out = test::run_kernel<Found>(GetParam(), kSource, in, "-DZERO_AREA=true");
  int met = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    met += out[i].hit;
    ASSERT_FALSE(out[i].hit && out[i].t != 0.0f) << i << " t = " << out[i].t;
  }
  EXPECT_GT(met, 1000) << "the line does pass through it as projected";
}

// ---- Seen edge-on

// t as the wide form's walks find it, in the lanes of a vector: NaN is in no interval. Both decisions on its
// sign.
const char* const kLanesSource =
    "#include \"primitives/triangle/intersect.clh\"\n"
    "typedef struct Case { float origin[3], direction[3]; float v[3][3]; } Case;\n"
    "typedef struct Found { int met; float det, t, settled_t; } Found;\n"
    "__kernel void test(__global const Case* in, __global Found* out, uint n) {\n"
    "  const uint i = get_global_id(0);\n"
    "  if (i >= n) return;\n"
    "  const RayShear s = make_shear(load3(in[i].direction));\n"
    "  const float3 o = load3(in[i].origin), d = load3(in[i].direction);\n"
    "  const float3 p = load3(in[i].v[0]), q = load3(in[i].v[1]), r = load3(in[i].v[2]);\n"
    "  const float3 a = p - o, b = q - o, c = r - o;\n"
    "#define OF(v, k) ((LANES)(component(v, k)))\n"
    "  const EdgeTest e = edge_test(OF(a, s.kx), OF(a, s.ky), OF(a, s.kz), OF(b, s.kx), OF(b, s.ky), OF(b, "
    "s.kz),\n"
    "                               OF(c, s.kx), OF(c, s.ky), OF(c, s.kz), (LANES)(s.sx), (LANES)(s.sy));\n"
    "  const LANES sz = (LANES)(s.sz), t = sz * (e.scaled_t / e.det);\n"
    "  const LANES settled = signed_t(t, e.det, OF(d, 0), OF(d, 1), OF(d, 2), OF(o, 0), OF(o, 1), OF(o, 2), "
    "OF(p, 0), OF(p, 1), OF(p, "
    "2),\n"
    "                                 OF(q, 0), OF(q, 1), OF(q, 2), OF(r, 0), OF(r, 1), OF(r, 2));\n"
    "  const LANES least = lesser(e.wa, lesser(e.wb, e.wc)), most = greater(e.wa, greater(e.wb, e.wc));\n"
    "  out[i].met = LANE(least) >= 0.0f || LANE(most) <= 0.0f;\n"
    "  out[i].det = LANE(e.det);\n"
    "  out[i].t = LANE(t);\n"
    "  out[i].settled_t = LANE(settled);\n"
    "}\n";
struct FoundInLanes {
  int met;
  float det, t, settled_t;
};

// The build options for a vector of n floats; its last lane is looked at.
std::string lanes_options(int n) {
  const std::string type = n == 1 ? "float" : "float" + std::to_string(n);
  const std::string form = n == 1 ? "real" : (n == 16 ? "real16" : type);  // common/real.clh
  const std::string lane = n == 1 ? "(v)" : (n == 4 ? "(v).s3" : (n == 8 ? "(v).s7" : "(v).sf"));
  return "-DLANES=" + type + " -DEdgeTest=EdgeTest_" + form + " -DLANE(v)=" + lane;
}

// Triangles with a ray along one of their edges, from its end or from beyond. The edge's slopes are exact, so
// that both of its corners project to 0 and the determinant is 0.
std::vector<Case> edge_on_cases(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> step(-16, 16), corner(0, 2);
  const auto point = [&] { return vec3(step(random), step(random), step(random)) / 16.0f; };
  // Found once: a hit at t = -1 in the walks of the wide form, none in the binary tree's.
  std::vector<Case> cases{make_case({-1, -1, 0}, {-2, -0.5f, -0.25f},
                                    {vec3(-1, -1, 0), vec3(1, -0.5f, 0.25f), vec3(0, 1, -0.5f)})};
  while (cases.size() < 20000) {
    vec3 edge = 2.0f * point();
    const int largest = corner(random);
    edge[largest] = random() % 2 ? 2.0f : -2.0f;
    std::array<vec3, 3> triangle{point(), vec3(0), point()};
    triangle[1] = triangle[0] + edge;
    const vec3 beyond = static_cast<float>(static_cast<int>(random() % 4) - 1) * edge;
    const vec3 origin = triangle[0] - beyond, direction = random() % 2 ? edge : -edge;
    if (glm::length(glm::cross(edge, triangle[2] - triangle[0])) == 0) continue;
    std::rotate(triangle.begin(), triangle.begin() + corner(random), triangle.end());
    cases.push_back(make_case(origin, direction, triangle));
  }
  return cases;
}

TEST_P(TriangleTest, SeenEdgeOnIsNoHitInAnyForm) {
  const unsigned seed = 10;
  SCOPED_TRACE(seed);
  const std::vector<Case> in = edge_on_cases(seed);
  for (const Found& found : test::run_kernel<Found>(GetParam(), kSource, in, "-DZERO_AREA=false"))
    ASSERT_FALSE(found.hit);
  for (const int lanes : {1, 4, 8, 16}) {
    SCOPED_TRACE(lanes);
    const auto out = test::run_kernel<FoundInLanes>(GetParam(), kLanesSource, in, lanes_options(lanes));
    for (std::size_t i = 0; i < out.size(); ++i) {
      ASSERT_TRUE(out[i].met) << i;  // the edge functions alone don't tell
      ASSERT_EQ(out[i].det, 0) << i;
      ASSERT_TRUE(std::isnan(out[i].t)) << i << " t = " << out[i].t;
      ASSERT_TRUE(std::isnan(out[i].settled_t)) << i << " t = " << out[i].settled_t;
    }
  }
}

void expect_met_ahead(const std::string& device, const Case& one, float t) {
  const std::vector<Case> in{one};
  const Found found = test::run_kernel<Found>(device, kSource, in, "-DZERO_AREA=false").front();
  EXPECT_TRUE(found.hit);
  EXPECT_NEAR(found.t, t, 1e-5f * t);
  for (const int lanes : {1, 4, 8, 16}) {
    const auto out = test::run_kernel<FoundInLanes>(device, kLanesSource, in, lanes_options(lanes));
    EXPECT_TRUE(out.front().met) << lanes;
    EXPECT_EQ(out.front().settled_t, found.t) << lanes;
  }
}

// From beyond an edge's end along it: the ray lies in the triangle's plane to the last bit, rounding lets
// it be met at the edge's end, and no other triangle there is. (Found by tests/stress, of a mesh from whose
// inside it leaked.)
TEST_P(TriangleTest, ATriangleAheadIsMetByARayInItsPlane) {
  const std::array<vec3, 3> triangle{vec3(-477.125f, 134.25f, 477.125f),
                                     vec3(-723.860352f, 28.8427734f, 1032.42676f),
                                     vec3(-415.8125f, 148.875f, 622.25f)};
  const vec3 origin(-0x1.d31ce6p+8f, 0x1.150df4p+7f, 0x1.c6977ep+8f),
      direction(-0x1.40634p+7f, -0x1.11be8p+6f, 0x1.68882p+8f);
  expect_met_ahead(GetParam(), make_case(origin, direction, triangle), 0.25748f);
}

// The same where the direction is 1e-8 off the plane. (Found by a campaign, of a lattice that is closed: its
// counts find the ray, and a line by the exact corners enters through another triangle beside this edge.)
TEST_P(TriangleTest, ATriangleAheadIsMetByARayThatBeginsInItsPlane) {
  const std::array<vec3, 3> one{vec3(-0x1.796e5ep+2f, -0x1.6d8972p+1f, 0x1.5c5496p+1f),
                                vec3(-0x1.9c2708p+2f, -0x1.6d8972p+1f, 0x1.16e342p+1f),
                                vec3(-0x1.9c2708p+2f, -0x1.b2fac6p+1f, 0x1.5c5496p+1f)};
  expect_met_ahead(GetParam(),
                   make_case({0x1.0aa76ap+5f, 0x1.48882ep+4f, 0x1.28fba2p+4f},
                             {-0x1.9f7d68p-1f, -0x1.ef716cp-2f, -0x1.4f8962p-2f}, one),
                   48.9594841f);
  const std::array<vec3, 3> other{vec3(-0x1.33fd0cp+2f, -0x1.b2fac6p+1f, 0x1.a1c5eap+1f),
                                  vec3(-0x1.114462p+2f, -0x1.b2fac6p+1f, 0x1.5c5496p+1f),
                                  vec3(-0x1.33fd0cp+2f, -0x1.6d8972p+1f, 0x1.5c5496p+1f)};
  expect_met_ahead(GetParam(),
                   make_case({-0x1.82f86ap+2f, -0x1.15cd44p+5f, 0x1.1e9962p+5f},
                             {0x1.bf5278p-6f, 0x1.62d8c8p-1f, -0x1.70d35cp-1f}, other),
                   45.2009125f);
}

// Whether, by every form of the test, none of these rays hits its triangle ahead, though many meet it.
void expect_none_ahead(const std::string& device, const std::vector<Case>& in) {
  for (const int lanes : {1, 4, 8, 16}) {
    SCOPED_TRACE(lanes);
    const auto out = test::run_kernel<FoundInLanes>(device, kLanesSource, in, lanes_options(lanes));
    int met = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      met += out[i].met;
      ASSERT_FALSE(out[i].met && out[i].settled_t > 0) << i << " t = " << out[i].settled_t;
    }
    EXPECT_GT(met, 10000);
  }
}

// Where products cancel, rounding alone puts corners ahead: of a ray across a plane, and of one that begins
// on an edge and runs across it.
TEST_P(TriangleTest, ARayAcrossThePlaneItStartsFromDoesNotHitIt) {
  const unsigned seed = 11;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const float half = std::sqrt(0.5f);
  const std::array<vec3, 3> roof{vec3(-1, -1, 1), vec3(1.5f, -1, -1.5f), vec3(0.2f, 1, -0.2f)};
  const std::array<vec3, 3> floor{vec3(0), vec3(1, 0, 0), vec3(1, 1, 0)};
  std::vector<Case> in;
  for (int i = 0; i < 20000; ++i) {
    const float s = 0.5f * unit(random), t = 0.5f * unit(random);
    vec3 origin = roof[0] + s * (roof[1] - roof[0]) + t * (roof[2] - roof[0]);
    origin.z = -origin.x;
    in.push_back(make_case(origin, {half, 0, half}, roof));
    const float along = unit(random), aside = unit(random) - 0.5f;
    in.push_back(make_case({along, along, 0}, {aside, -aside, 0.3f + unit(random)}, floor));
  }
  expect_none_ahead(GetParam(), in);
}

// Pairs of floats alone would put the plane before or behind its own second and third corner.
TEST_P(TriangleTest, ARayFromACornerDoesNotHitTheTriangle) {
  const unsigned seed = 12;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::normal_distribution<float> any;
  const auto some = [&] { return vec3(any(random), any(random), any(random)); };
  std::vector<Case> in;
  for (int i = 0; i < 30000; ++i) {
    const std::array<vec3, 3> triangle{some(), some(), some()};
    in.push_back(make_case(triangle[static_cast<std::size_t>(i % 3)], some(), triangle));
  }
  for (const auto& found : test::run_kernel<Found>(GetParam(), kSource, in, "-DZERO_AREA=false"))
    ASSERT_FALSE(found.hit && found.t > 0) << found.t;
  expect_none_ahead(GetParam(), in);
}

KDRAY_FOR_EACH_DEVICE(TriangleTest);

}  // namespace
}  // namespace kdray
