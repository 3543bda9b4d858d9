// Snell's law at all angles and about the critical one: which rays are refracted and where to, against
// double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stress/random.h"
#include "stress/table.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 66;

struct In {
  float d[3], n[3], eta;
};
struct Out {
  float d[3];
  std::int32_t refracted;
};

const char* const kSource = R"(#include "shade/secondary.clh"
typedef struct In { float d[3], n[3], eta; } In;
typedef struct Out { float d[3]; int refracted; } Out;
__kernel void test(__global const In* in, __global Out* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Real3xN d = splat3(load3(in[i].d)), normal = splat3(load3(in[i].n));
  Real3xN t;
  const lanes16 refracted = refracted_direction(d, normal, normal, (float16)(in[i].eta), &t);
  const Out o = {{t.x.s3, t.y.s3, t.z.s3}, refracted.s3 != 0};
  out[i] = o;
}
)";

dvec3 point3(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// Half of the rays at random, half within 1e-1 to 1e-8 of the critical angle.
In make(std::uint64_t i) {
  Random random(kSeed, i);
  const double eta = random.log_uniform(0.3, 3);
  const dvec3 n(vec3(random.direction()));
  double sine = random.uniform();
  if (random.bits() & 1) sine = std::clamp(1 / eta + random.signed_log_uniform(1e-8, 1e-1), 0.0, 1.0);
  const dvec3 across = glm::normalize(glm::cross(n, random.direction()));
  const vec3 d(glm::normalize(sine * across - std::sqrt(1 - sine * sine) * n)), normal(n);
  return {{d.x, d.y, d.z}, {normal.x, normal.y, normal.z}, static_cast<float>(eta)};
}

class Refraction : public test::EachDevice {};

TEST_P(Refraction, AtAllAnglesAndTheCriticalOne) {
  std::vector<In> in(std::min<std::uint64_t>(rays_to_trace(0.03), 10000000));
  for (std::size_t i = 0; i < in.size(); ++i) in[i] = make(i);
  const std::vector<Out> out = test::run_kernel<Out>(GetParam(), kSource, in);
  std::uint64_t wrong = 0, near = 0, refracted = 0;
  double worst = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const dvec3 d = glm::normalize(point3(in[i].d)), n = glm::normalize(point3(in[i].n));
    const double eta = in[i].eta, cosine = -glm::dot(d, n);
    const dvec3 along = eta * (d + cosine * n);
    const double cos2 = 1 - glm::dot(along, along);
    constexpr double kError = 16 * 0x1p-24;
    refracted += out[i].refracted;
    if (std::abs(cos2) <= kError * std::max(1.0, eta * eta)) {
      ++near;
      continue;
    }
    if ((cos2 > 0) != (out[i].refracted != 0)) ++wrong;
    if (cos2 <= 0 || !out[i].refracted) continue;
    const double apart = glm::length(point3(out[i].d) - (along - std::sqrt(cos2) * n));
    // An error of cos2 moves the cosine by that over twice the cosine.
    const double share = apart / (0x1p-24 * std::max(1.0, eta * eta) * (4 + 4 / std::sqrt(cos2)));
    worst = std::max(worst, share);
    if (!(share <= 2)) ++wrong;
  }
  add(Row{"refraction", "all angles and the critical one", "-", in.size(), wrong, near});
  EXPECT_EQ(wrong, 0) << "seed " << kSeed << "; the worst is " << worst << " of what is expected of rounding";
  EXPECT_GT(refracted, in.size() / 4);
  EXPECT_LT(refracted, in.size() * 15 / 16);
  EXPECT_LT(near, in.size() / 4);
}

KDRAY_FOR_EACH_DEVICE(Refraction);

}  // namespace
}  // namespace kdray::stress
