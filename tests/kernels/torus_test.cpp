// The torus test against the quartic, in long double: hits lie on the surface, what goes deeper below it than
// the cells of the tree leave room for is hit, crossings are even in number, and all forms of vectors give
// the same bits. The lines touch it, along its flattest directions too, or nearly so.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <set>

#include "base/vec.h"
#include "layout/primitives.layout.h"
#include "oracle/polynomial.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

constexpr unsigned kSeed = 20261125;
constexpr int kCrossings = 4;
using Real = long double;
using RealVec = glm::vec<3, Real>;

struct Case {
  layout::Torus torus;
  float origin[3], direction[3];
};
struct Found {
  float t[kCrossings];  // NaN where there is none
};

void set(float (&out)[3], const vec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}
RealVec real(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// ---- What the kernels find.

// For vectors of so many lanes; from the start, or, where t_min is -INFINITY, of the whole line.
std::string kernel_of(const std::string& type, int lanes, const std::string& t_min) {
  return fmt::format(
      "#include \"primitives/torus/intersect.clh\"\n"
      "typedef struct Case {{ Torus torus; float origin[3], direction[3]; }} Case;\n"
      "typedef struct Found {{ float t[4]; }} Found;\n"
      "#define ROW(name, what) float name##s[{1}]; \\\n"
      "  for (uint k = 0; k < {1}u; ++k) name##s[k] = in[min(first + k, n - 1)].what; \\\n"
      "  {0} name; for (uint k = 0; k < {1}u; ++k) ((float*)&name)[k] = name##s[k];\n"
      "__kernel void test(__global const Case* in, __global Found* out, uint n) {{\n"
      "  const uint i = get_global_id(0), first = i - i % {1}u;\n"
      "  if (i >= n) return;\n"
      "  ROW(ox, origin[0]) ROW(oy, origin[1]) ROW(oz, origin[2])\n"
      "  ROW(dx, direction[0]) ROW(dy, direction[1]) ROW(dz, direction[2])\n"
      "  ROW(cx, torus.center[0]) ROW(cy, torus.center[1]) ROW(cz, torus.center[2])\n"
      "  ROW(nx, torus.axis[0]) ROW(ny, torus.axis[1]) ROW(nz, torus.axis[2])\n"
      "  ROW(major, torus.major_radius) ROW(minor, torus.minor_radius)\n"
      "  const {0} a = KDRAY_DOT(dx, dy, dz, dx, dy, dz), inverse_a = 1.0f / a, one = ({0})(1.0f);\n"
      "  const TorusLine_{0} near =\n"
      "      torus_line(ox - cx, oy - cy, oz - cz, dx, dy, dz, a, inverse_a, nx, ny, nz, major, minor);\n"
      "  const {0} searched = torus_nearness(near) >= 0.0f ? one : ({0})(0.0f);\n"
      "  const TorusLine_{0} line = torus_past_axis(near);\n"
      "  const TorusTurns_{0} turns = torus_turns(line, inverse_a, searched);\n"
      "  const {0} start = torus_start(line, ({0})({2})), inside = torus_inside(line, start);\n"
      "  for (uint k = 0; k < 4u; ++k) {{\n"
      "    const {0} t = torus_crossing(line, turns, k, start, inside, searched);\n"
      "    out[i].t[k] = ((float*)&t)[i - first];\n"
      "  }}\n"
      "}}\n",
      type, lanes, t_min);
}

std::vector<Found> crossings_of(const std::string& device, const std::vector<Case>& in,
                                const std::string& type = "real", int lanes = 1,
                                const std::string& t_min = "-INFINITY") {
  return test::run_kernel<Found>(device, kernel_of(type, lanes, t_min), in);
}

// The first hit beyond each t_min, by the test of a ray against one torus.
std::vector<Found> firsts_of(const std::string& device, const std::vector<Case>& in) {
  return test::run_kernel<Found>(
      device,
      "#include \"primitives/torus/intersect.clh\"\n"
      "typedef struct Case { Torus torus; float origin[3], direction[3]; } Case;\n"
      "typedef struct Found { float t[4]; } Found;\n"
      "__kernel void test(__global const Case* in, __global Found* out, uint n) {\n"
      "  const uint i = get_global_id(0);\n"
      "  if (i >= n) return;\n"
      "  float t = 0.0f;\n"
      "  for (uint k = 0; k < 4u; ++k) {\n"
      "    t = intersect_torus(load3(in[i].origin), load3(in[i].direction), &in[i].torus, t);\n"
      "    out[i].t[k] = t;\n"
      "  }\n"
      "}\n",
      in);
}

struct FoundInDouble {
  double t[kCrossings];
};
std::vector<FoundInDouble> firsts_in_double(const std::string& device, const std::vector<Case>& in) {
  return test::run_kernel<FoundInDouble>(
      device,
      "#include \"primitives/torus/intersect.clh\"\n"
      "typedef struct Case { Torus torus; float origin[3], direction[3]; } Case;\n"
      "typedef struct Found { double t[4]; } Found;\n"
      "__kernel void test(__global const Case* in, __global Found* out, uint n) {\n"
      "  const uint i = get_global_id(0);\n"
      "  if (i >= n) return;\n"
      "  double t = -INFINITY;\n"
      "  for (uint k = 0; k < 4u; ++k) {\n"
      "    t = intersect_torus(load3(in[i].origin), load3(in[i].direction), &in[i].torus, t);\n"
      "    out[i].t[k] = t;\n"
      "  }\n"
      "}\n",
      in, "-DKDRAY_PRECISION=64");
}

std::vector<Real> present(const Found& found) {
  std::vector<Real> all;
  for (const float t : found.t)
    if (!std::isnan(t)) all.push_back(t);
  return all;
}

// ---- What is true.

struct Truth {
  RealVec from, direction, axis;  // from the centre
  Real major, minor, largest;     // M of traverse/ray.clh

  explicit Truth(const Case& c)
      : from(real(c.origin) - real(c.torus.center)),
        direction(real(c.direction)),
        axis(glm::normalize(real(c.torus.axis))),
        major(c.torus.major_radius),
        minor(c.torus.minor_radius) {
    largest = 0;
    for (int k = 0; k < 3; ++k) {
      const Real reach = major * std::sqrt(std::max<Real>(0, 1 - axis[k] * axis[k])) + minor;
      largest = std::max(largest, std::abs(from[k]) + reach);
    }
  }
  // Of the place at t from the surface; below 0 inside.
  Real distance(Real t) const {
    const RealVec p = from + t * direction;
    const Real z = glm::dot(p, axis);
    return std::hypot(glm::length(p - z * axis) - major, z) - minor;
  }
  std::vector<Real> roots() const {
    const Real dd = glm::dot(direction, direction), middle = -glm::dot(from, direction) / dd;
    const RealVec g = from + middle * direction;
    const auto quartic =
        oracle::torus_quartic<Real>(glm::dot(g, g), glm::dot(g, direction), dd, glm::dot(g, axis),
                                    glm::dot(direction, axis), major, minor);
    const Real reach = 2 * (major + minor) / std::sqrt(dd);
    std::vector<Real> all = oracle::roots_of<Real>(quartic, -reach, reach, 80);
    for (Real& t : all) t += middle;
    return all;
  }
  // What the cells leave, and what the rounding of t itself makes along the line.
  Real allowed(Real t) const { return 0x1p-24L * (14 * largest + std::abs(t) * glm::length(direction)); }
};

bool within(const std::vector<Real>& ends, Real t) {
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2)
    if (ends[k] <= t && t <= ends[k + 1]) return true;
  return false;
}

// In parts of what is allowed.
struct Errors {
  Real off = 0, lost = 0, made = 0;
  int hits = 0, four = 0;
};

// Between each two of `ends`, where the others say otherwise: the most that the places are on the other side.
Real farthest(const Truth& truth, const std::vector<Real>& ends, const std::vector<Real>& others, Real side) {
  Real most = 0;
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2)
    for (int i = 1; i < 64; ++i) {
      const Real t = ends[k] + (ends[k + 1] - ends[k]) * i / 64;
      if (!within(others, t)) most = std::max(most, side * truth.distance(t) / truth.allowed(t));
    }
  return most;
}

void judge(const Case& c, const Found& found, Errors& errors) {
  const Truth truth(c);
  const std::vector<Real> roots = truth.roots(), hits = present(found);
  ASSERT_EQ(hits.size() % 2, 0u);
  ASSERT_TRUE(std::ranges::is_sorted(hits));
  errors.hits += static_cast<int>(hits.size()), errors.four += hits.size() == 4;
  for (const Real t : hits) errors.off = std::max(errors.off, std::abs(truth.distance(t)) / truth.allowed(t));
  errors.lost = std::max(errors.lost, farthest(truth, roots, hits, -1));
  errors.made = std::max(errors.made, farthest(truth, hits, {}, 1));
}

// ---- Lines.

class Lines {
 public:
  explicit Lines(unsigned seed) : random_(seed) {}

  float unit() { return std::uniform_real_distribution<float>(-1, 1)(random_); }
  vec3 any() { return {unit(), unit(), unit()}; }
  // From 1 down to where it is nothing beside 1, either sign.
  float little() { return unit() * std::exp2(-24 * std::abs(unit())); }

  // The k-th way for a line to pass a place of the surface; it starts `away` lengths of the direction before.
  static constexpr int kWays = 12;
  Case pass(int way, float ratio, float away) {
    Case c{};
    c.torus.major_radius = 1, c.torus.minor_radius = 1 / ratio;
    const bool straight = count_++ % 5 == 0;
    const vec3 n = straight ? vec3(0, 0, 1) : glm::normalize(any() + vec3(0, 0, 1e-3f));
    set(c.torus.axis, n);
    const vec3 out = glm::normalize(glm::cross(n, any() + vec3(1e-3f, 0, 0))), along = glm::cross(n, out);
    float angle = std::numbers::pi_v<float> * unit();
    if (way == 6 || way == 7) angle = way == 6 ? 0 : std::numbers::pi_v<float>;  // the equators
    if (way == 9) angle = std::numbers::pi_v<float> / 2;
    const vec3 normal = std::cos(angle) * out + std::sin(angle) * n;
    const vec3 around = -std::sin(angle) * out + std::cos(angle) * n;
    const float r = c.torus.minor_radius;
    vec3 place = out + r * normal, d;
    switch (way) {
      case 0:
        d = any();
        break;
      case 1:
        d = unit() * along + unit() * around;
        break;  // in the tangent plane
      case 2:
        d = unit() * along + unit() * around, place -= little() * r * normal;
        break;
      case 3:
        d = along + little() * around;
        break;
      case 4:
        d = along + little() * normal;
        break;
      case 5:
        d = n + (count_ % 2 ? 0.0f : little()) * any();
        break;
      case 6:
        d = unit() * along + unit() * out;
        break;  // in the plane of the equator
      case 7:
        d = along + (1 + little()) * std::sqrt(r / (1 - r)) * n, place -= little() * r * normal;
        break;
      case 8:
        d = vec3(0), d[count_ % 3] = count_ % 2 ? 1.0f : -1.0f;
        break;
      case 9:
        d = along + unit() * out, place += little() * r * n;
        break;  // in the plane on top
      case 10:
        d = n, place = little() * any();
        break;  // along the axis
      default:
        d = out + little() * any(), place = vec3(0);
        break;  // through the centre
    }
    set(c.direction, d);
    set(c.origin, place - away * d);
    return c;
  }

 private:
  std::mt19937 random_;
  int count_ = 0;
};

std::vector<Case> cases(unsigned seed, int n, float ratio, float away) {
  Lines lines(seed);
  std::vector<Case> all;
  for (int i = 0; i < n; ++i) all.push_back(lines.pass(i % Lines::kWays, ratio, away));
  return all;
}

class TorusTest : public test::EachDevice {};

TEST_P(TorusTest, HitsAreOnItAndNoneIsLost) {
  for (const float ratio : {1.0001f, 1.5f, 4.0f, 100.0f, 4096.0f})
    for (const float away : {0.0f, 1.0f, 100.0f, 1e4f}) {
      SCOPED_TRACE(testing::Message() << "R/r " << ratio << ", from " << away << " away, seed " << kSeed);
      const std::vector<Case> in = cases(kSeed, 1200, ratio, away);
      const std::vector<Found> out = crossings_of(GetParam(), in);
      Errors errors;
      for (std::size_t i = 0; i < in.size() && !HasFatalFailure(); ++i) judge(in[i], out[i], errors);
      EXPECT_LT(errors.off, 1) << "a hit is farther off the surface than cells are widened by";
      EXPECT_LT(errors.lost, 1) << "a line goes deeper than that and is not hit";
      EXPECT_LT(errors.made, 1) << "a line is inside where it is farther out than that";
      EXPECT_GT(errors.hits, 800);
      std::cout << fmt::format("R/r {} from {}: {} hits, {} of four; off {:.2f}, lost {:.2f}, made {:.2f}\n",
                               ratio, away, errors.hits, errors.four, static_cast<double>(errors.off),
                               static_cast<double>(errors.lost), static_cast<double>(errors.made));
    }
}

bool same_bits(const Found& a, const Found& b) {
  for (int k = 0; k < kCrossings; ++k)
    if (std::bit_cast<std::uint32_t>(a.t[k]) != std::bit_cast<std::uint32_t>(b.t[k]) &&
        !(std::isnan(a.t[k]) && std::isnan(b.t[k])))
      return false;
  return true;
}

TEST_P(TorusTest, VectorsOfAnyWidthGiveTheSameBits) {
  std::vector<Case> in;
  for (const float ratio : {1.01f, 4.0f, 300.0f}) {
    const std::vector<Case> some = cases(kSeed + 1, 1000, ratio, 3);
    in.insert(in.end(), some.begin(), some.end());
  }
  const std::vector<Found> wanted = crossings_of(GetParam(), in);
  for (const auto& [type, lanes] :
       {std::pair{"float4", 4}, std::pair{"float8", 8}, std::pair{"real16", 16}}) {
    const std::vector<Found> out = crossings_of(GetParam(), in, type, lanes);
    std::size_t same = 0;
    for (std::size_t i = 0; i < in.size(); ++i) same += same_bits(out[i], wanted[i]);
    EXPECT_EQ(same, in.size()) << lanes << " lanes, seed " << kSeed + 1;
  }
}

// A torus and its rays, all of them 2^k times as large: so is t, to the bit.
TEST_P(TorusTest, ItsSizeDoesNotMatter) {
  const std::vector<Case> in = cases(kSeed + 2, 1200, 3, 1);
  const std::vector<Found> wanted = crossings_of(GetParam(), in);
  for (const int power : {-36, -11, 12}) {
    std::vector<Case> scaled = in;
    const float by = std::ldexp(1.0f, power);
    for (Case& c : scaled) {
      c.torus.major_radius *= by, c.torus.minor_radius *= by;
      for (float& v : c.origin) v *= by;
    }
    const std::vector<Found> out = crossings_of(GetParam(), scaled);
    std::size_t same = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      Found back = out[i];
      for (float& t : back.t) t /= by;
      same += same_bits(back, wanted[i]);
    }
    EXPECT_EQ(same, in.size()) << "2^" << power << ", seed " << kSeed + 2;
  }
}

// So small that squares of its radii are no floats: it may be hit or not, but by numbers and in pairs.
TEST_P(TorusTest, OneThatFloatsCanHardlyHoldIsCrossedInPairs) {
  std::vector<Case> in = cases(kSeed + 3, 1200, 3, 1);
  std::set<std::size_t> counts;
  for (const float by : {1e-15f, 1e-21f, 1e-30f, 1e-40f}) {
    std::vector<Case> tiny = in;
    for (Case& c : tiny) c.torus.major_radius *= by, c.torus.minor_radius *= by;
    for (std::size_t i = 0; i < tiny.size(); i += 2)
      set(tiny[i].origin, -vec3(tiny[i].direction[0], tiny[i].direction[1], tiny[i].direction[2]));
    for (const Found& found : crossings_of(GetParam(), tiny)) {
      counts.insert(present(found).size());
      for (const Real t : present(found)) EXPECT_TRUE(std::isfinite(t));
    }
  }
  for (const std::size_t n : counts) EXPECT_EQ(n % 2, 0u);
}

TEST_P(TorusTest, TheFirstBeyondEachCrossingIsTheNext) {
  std::vector<Case> in = cases(kSeed + 4, 3000, 4, 5);
  const std::vector<Found> all = crossings_of(GetParam(), in, "real", 1, "0.0f");
  const std::vector<Found> firsts = firsts_of(GetParam(), in);
  int several = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    std::vector<Real> wanted = present(all[i]);
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());  // where it touches
    several += wanted.size() > 2;
    EXPECT_EQ(present(firsts[i]), wanted) << i << ", seed " << kSeed + 4;
  }
  EXPECT_GT(several, 100);
}

// By the same bound, in parts of double's u.
TEST_P(TorusTest, DoubleIsAsExactForItsSize) {
  for (const float ratio : {1.01f, 4.0f, 100.0f}) {
    const std::vector<Case> in = cases(kSeed + 5, 6000, ratio, 3);
    const std::vector<FoundInDouble> out = firsts_in_double(GetParam(), in);
    Real worst = 0;
    int hits = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Truth truth(in[i]);
      for (const double t : out[i].t) {
        if (std::isnan(t)) continue;
        ++hits;
        worst = std::max(worst, std::abs(truth.distance(t)) / (truth.allowed(t) * 0x1p-29L));
      }
    }
    EXPECT_GT(hits, 5000);
    EXPECT_LT(worst, 1) << "R/r " << ratio << ", seed " << kSeed + 5;
  }
}

KDRAY_FOR_EACH_DEVICE(TorusTest);

}  // namespace
}  // namespace kdray
