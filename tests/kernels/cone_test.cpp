// The cone test: every root lies on the surface and within its length, and agrees in number with a scan in
// double; the first beyond a distance is the same, whatever the distance.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/vec.h"
#include "layout/primitives.layout.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

struct Case {
  layout::Cone cone;
  float origin[3], direction[3];
};
struct Found {
  int hit;
  float t[2];
};

void set(float (&out)[3], const vec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}

// Signed distance-like value: |across| - radius at the height of p; the height through `s`.
double off_surface(const layout::Cone& c, const dvec3& p, double* s) {
  const dvec3 axis(c.axis[0], c.axis[1], c.axis[2]), from = p - dvec3(c.base[0], c.base[1], c.base[2]);
  *s = glm::dot(from, axis);
  return glm::length(from - *s * axis) - (c.base_radius + c.slope * *s);
}

Case random_case(std::mt19937& random, int i) {
  std::uniform_real_distribution<float> unit(-1, 1), size(0.05f, 2);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  Case c{};
  const vec3 base = point(), axis = glm::normalize(point() + vec3(0, 0, 1e-3f));
  const float r0 = size(random),
              r1 = i % 3 == 0 ? r0 : (i % 3 == 1 ? 0.0f : size(random));  // cylinder, tip, frustum
  set(c.cone.base, base);
  set(c.cone.axis, axis);
  c.cone.height = size(random);
  c.cone.base_radius = r0;
  c.cone.slope = (r1 - r0) / c.cone.height;
  const vec3 target = base + axis * (c.cone.height * 0.5f * (unit(random) + 1)) + 0.5f * point();
  const vec3 origin = target + point() * (i % 2 ? 3.0f : 300.0f);
  set(c.origin, origin);
  set(c.direction, glm::normalize(target - origin));
  return c;
}

// Sign changes of off_surface along the ray within the cone's length, by a fine scan around it.
int crossings(const Case& c, bool* clear) {
  const dvec3 o(c.origin[0], c.origin[1], c.origin[2]), d(c.direction[0], c.direction[1], c.direction[2]);
  const double reach =
      c.cone.height + std::max<double>(c.cone.base_radius, c.cone.base_radius + c.cone.slope * c.cone.height);
  const dvec3 base(c.cone.base[0], c.cone.base[1], c.cone.base[2]);
  const double middle = glm::dot(base - o, d);
  constexpr int kSteps = 4000;
  int count = 0;
  double last = 0, last_s = 0;
  *clear = true;
  for (int i = 0; i <= kSteps; ++i) {
    double s;
    const double value = off_surface(c.cone, o + d * (middle + reach * (2.0 * i / kSteps - 1) * 1.5), &s);
    const bool inside = s >= 0 && s <= c.cone.height;
    if (std::abs(value) < 2e-3 && (std::abs(s) < 0.01 || std::abs(s - c.cone.height) < 0.01))
      *clear = false;  // the rim
    if (i > 0 && (value > 0) != (last > 0) && inside && last_s >= 0 && last_s <= c.cone.height) ++count;
    // Touching without crossing between two steps can't be told by a scan.
    if (i > 0 && inside && std::abs(value) < 1e-3 * reach && (value > 0) == (last > 0))
      *clear = *clear && std::abs(value - last) > 2e-4;
    last = value, last_s = s;
  }
  return count;
}

std::vector<Found> roots_of(const std::string& device, const std::vector<Case>& in) {
  return test::run_kernel<Found>(
      device,
      "#include \"primitives/cone/intersect.clh\"\n"
      "typedef struct Case { Cone cone; float origin[3], direction[3]; } Case;\n"
      "typedef struct Found { int hit; float t[2]; } Found;\n"
      "__kernel void test(__global const Case* in, __global Found* out, uint n) {\n"
      "  const uint i = get_global_id(0);\n"
      "  if (i >= n) return;\n"
      "  const float3 o = load3(in[i].origin), d = load3(in[i].direction);\n"
      "  const float first = intersect_cone(o, d, &in[i].cone, -INFINITY).t;\n"
      "  const float next = intersect_cone(o, d, &in[i].cone, first).t;\n"
      "  const float second = next > first ? next : NAN;\n"
      "  const Found f = {!isnan(first), {first, second}};\n"
      "  out[i] = f;\n"
      "}\n",
      in);
}

class ConeTest : public test::EachDevice {};

TEST_P(ConeTest, RootsLieOnTheSurfaceAndNoneIsMissing) {
  const unsigned seed = 31;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<Case> in;
  for (int i = 0; i < 6000; ++i) in.push_back(random_case(random, i));
  const std::vector<Found> out = roots_of(GetParam(), in);
  int compared = 0, hits = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const dvec3 o(in[i].origin[0], in[i].origin[1], in[i].origin[2]);
    const dvec3 d(in[i].direction[0], in[i].direction[1], in[i].direction[2]);
    int found = 0;
    for (const float t : out[i].t) {
      if (std::isnan(t)) continue;
      ++found;
      double s;
      const double off = off_surface(in[i].cone, o + d * static_cast<double>(t), &s);
      const double tolerance = 64 * 0x1p-24 * (glm::length(o) + 4);
      EXPECT_NEAR(off, 0, 40 * tolerance) << i;  // steep where the ray grazes
      EXPECT_GT(s, -tolerance) << i;
      EXPECT_LT(s, in[i].cone.height + tolerance) << i;
    }
    bool clear;
    const int wanted = crossings(in[i], &clear);
    if (!clear) continue;
    ++compared;
    hits += wanted > 0;
    EXPECT_EQ(found, wanted) << i;
  }
  EXPECT_GT(compared, 4000);
  EXPECT_GT(hits, 1500);
}

// Rays from near the surface of a cone a hundred times as wide as it is high, almost along its axis: the
// stress suite found a root 0.85 off. They come nearest to the axis thousands of heights away.
TEST_P(ConeTest, AlmostAlongTheAxisOfAFlatCone) {
  const unsigned seed = 32;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  Case c{};
  set(c.cone.base, vec3(0x1.8cfebep+1f, -0x1.50926cp-1f, 0x1.4fa0d6p-1f));
  c.cone.base_radius = 0x1.099e38p+12f, c.cone.slope = -0x1.89b74ep+6f;
  c.cone.axis[2] = 1, c.cone.height = 0x1.596ae6p+5f;
  const vec3 base(c.cone.base[0], c.cone.base[1], c.cone.base[2]);
  std::vector<Case> in;
  for (int i = 0; i < 4000; ++i) {
    const float s = c.cone.height - 0.5f - 0.5f * unit(random);
    const vec3 on_it(c.cone.base_radius + c.cone.slope * s, 0, s);
    set(c.origin, base + on_it + vec3(0, 0, 1e-4f * unit(random)));
    set(c.direction, glm::normalize(vec3(0.02f * unit(random), 0.02f * unit(random), i % 2 ? -1 : 1)));
    in.push_back(c);
  }
  const std::vector<Found> out = roots_of(GetParam(), in);
  int hits = 0;
  for (std::size_t i = 0; i < in.size(); ++i)
    for (const float t : out[i].t) {
      if (std::isnan(t)) continue;
      ++hits;
      const dvec3 o(in[i].origin[0], in[i].origin[1], in[i].origin[2]);
      const dvec3 d(in[i].direction[0], in[i].direction[1], in[i].direction[2]);
      double s;
      const double across = off_surface(in[i].cone, o + d * static_cast<double>(t), &s);
      // The distance from the surface itself, which is nearly level.
      EXPECT_LT(std::abs(across) / std::hypot(1, in[i].cone.slope), 1e-4) << i;
    }
  EXPECT_GT(hits, 3000);
}

// A cone's axis, base, and a direction away from the axis.
struct Flank {
  vec3 axis, base, side;
};

Flank any_flank(const layout::Cone& cone, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const vec3 axis(cone.axis[0], cone.axis[1], cone.axis[2]);
  const float u = unit(random), v = unit(random);
  return {axis, vec3(cone.base[0], cone.base[1], cone.base[2]),
          glm::normalize(glm::cross(axis, vec3(u, v, 1.5f)))};
}

// Lines that touch a cone, or all but touch it: their two roots are nearly one.
Case touching_case(std::mt19937& random, int i) {
  std::uniform_real_distribution<float> unit(-1, 1);
  Case c = random_case(random, i);
  const auto [axis, base, side] = any_flank(c.cone, random);
  const float s = c.cone.height * (0.5f + 0.4f * unit(random)), r = c.cone.base_radius + c.cone.slope * s;
  const vec3 touched = base + axis * s + side * r, normal = glm::normalize(side - c.cone.slope * axis);
  const vec3 along = glm::normalize(0.2f * unit(random) * glm::cross(normal, glm::cross(axis, side)) +
                                    glm::cross(axis, side));
  const float off = 1e-5f * r * unit(random) * unit(random);
  set(c.origin, touched - normal * off - along * (0.5f + unit(random)) * (i % 2 ? 3.0f : 300.0f));
  set(c.direction, along);
  return c;
}

// Tips, needles, lines that graze, that run along the axis or come from far away.
Case grazing_case(std::mt19937& random, int i) {
  std::uniform_real_distribution<float> unit(-1, 1);
  Case c = random_case(random, i);
  if (i % 5 == 0) c.cone.base_radius *= 1e-3f, c.cone.slope *= 1e-3f;
  const auto [axis, base, side] = any_flank(c.cone, random);
  const float s = c.cone.height * 0.5f * (unit(random) + 1);
  const vec3 touched = base + axis * s + side * (c.cone.base_radius + c.cone.slope * s);
  const float tilt = std::pow(10.0f, -4 * std::abs(unit(random)));
  const vec3 along =
      glm::normalize(axis + tilt * (unit(random) * glm::cross(axis, side) + 0.1f * unit(random) * side));
  set(c.origin, touched - along * (i % 3 == 0 ? 3e3f : 3.0f) * (1 + unit(random)));
  set(c.direction, along);
  return c;
}

TEST_P(ConeTest, NearnessKeepsEveryLineThatHits) {
  const unsigned seed = 32;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<Case> in;
  for (int i = 0; i < 200000; ++i) in.push_back(i % 2 ? random_case(random, i) : grazing_case(random, i));
  struct Answer {
    int has_root, is_near;
  };
  const std::vector<Answer> out = test::run_kernel<Answer>(
      GetParam(),
      "#include \"primitives/cone/intersect.clh\"\n"
      "typedef struct Case { Cone cone; float origin[3], direction[3]; } Case;\n"
      "__kernel void test(__global const Case* in, __global int2* out, uint n) {\n"
      "  const uint i = get_global_id(0);\n"
      "  if (i >= n) return;\n"
      "  __global const Cone* c = &in[i].cone;\n"
      "  const float3 f = load3(in[i].origin) - load3(c->base), d = load3(in[i].direction), n3 = "
      "load3(c->axis);\n"
      "  const float a = dot3(d, d);\n"
      "  const ConeHit_real hit = cone_test(f.x, f.y, f.z, d.x, d.y, d.z, a, 1 / a, n3.x, n3.y, n3.z,\n"
      "                                     c->base_radius, c->height, c->slope, -INFINITY);\n"
      "  const float near = cone_nearness(f.x, f.y, f.z, d.x, d.y, d.z, a, 1 / a, n3.x, n3.y, n3.z,\n"
      "                                   c->base_radius, c->height, c->slope);\n"
      "  out[i] = (int2)(!isnan(hit.t), near >= 0);\n"
      "}\n",
      in);
  int roots = 0, misses = 0, passed_by = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (out[i].has_root) {
      ++roots;
      EXPECT_TRUE(out[i].is_near) << i;
    } else {
      ++misses;
      passed_by += !out[i].is_near;
    }
  }
  EXPECT_GT(roots, 50000);
  EXPECT_GT(passed_by, misses / 8);
}

// cone_test refines the root that is the first, the other where that one is not beyond t_min after all. So no
// t_min, however near to a root, may give anything but the first of the same two that are beyond it; also of
// lines that all but touch the cone, whose roots may have gone past each other: occlusion and closest hits
// ask for one and the same (the stress suite once found a shadow ray that was occluded by nothing).
TEST_P(ConeTest, TheFirstHitBeyondAnyDistanceIsOneOfTheSameTwo) {
  const unsigned seed = 33;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<Case> in;
  for (int i = 0; i < 30000; ++i)
    in.push_back(i % 3 == 0   ? random_case(random, i)
                 : i % 3 == 1 ? grazing_case(random, i)
                              : touching_case(random, i));
  struct Answer {
    int asked, wrong, second;
  };
  const std::vector<Answer> out = test::run_kernel<Answer>(
      GetParam(),
      "#include \"primitives/cone/intersect.clh\"\n"
      "typedef struct Case { Cone cone; float origin[3], direction[3]; } Case;\n"
      "typedef struct Answer { int asked, wrong, second; } Answer;\n"
      "__kernel void test(__global const Case* in, __global Answer* out, uint n) {\n"
      "  const uint i = get_global_id(0);\n"
      "  if (i >= n) return;\n"
      "  const float3 o = load3(in[i].origin), d = load3(in[i].direction);\n"
      "  const ConeHit_real first = intersect_cone(o, d, &in[i].cone, -INFINITY);\n"
      "  const ConeHit_real next = intersect_cone(o, d, &in[i].cone, first.t);\n"
      "  const int two = next.t > first.t;\n"
      "  Answer a = {0, 0, 0};\n"
      "  for (int k = -12; k <= 12; ++k) {\n"
      "    const float share = k == 0 ? 0.0f : copysign(ldexp(1.0f, 4 - 2 * abs(k)), (float)k);\n"
      "    const float bounds[3] = {first.t + share * fabs(first.t), next.t + share * fabs(next.t),\n"
      "                             mix(first.t, next.t, share)};\n"
      "    for (int j = 0; j < 3; ++j) {\n"
      "      const float t_min = bounds[j];\n"
      "      if (isnan(t_min)) continue;\n"
      "      const ConeHit_real hit = intersect_cone(o, d, &in[i].cone, t_min);\n"
      "      const int is_first = first.t > t_min, is_second = !is_first && two && next.t > t_min;\n"
      "      ++a.asked;\n"
      "      a.second += is_second;\n"
      "      a.wrong += is_first    ? hit.t != first.t || hit.s != first.s\n"
      "                 : is_second ? hit.t != next.t || hit.s != next.s\n"
      "                             : hit.t > t_min;\n"
      "    }\n"
      "  }\n"
      "  out[i] = a;\n"
      "}\n",
      in);
  long asked = 0, second = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    EXPECT_EQ(out[i].wrong, 0) << i;
    asked += out[i].asked, second += out[i].second;
  }
  EXPECT_GT(asked, 500000);
  EXPECT_GT(second, 50000);
}

KDRAY_FOR_EACH_DEVICE(ConeTest);

}  // namespace
}  // namespace kdray
