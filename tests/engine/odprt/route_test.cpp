// What    The parts that a ray asks one after the other (kernels/odprt/route.clh, way.clh), on the device,
//         against the definition in double: each that it meets before its end, once, in the order in which it
//         enters the first of their cells.
// Shape   Random cells, also flat and touching ones, and rays of all kinds, axis-parallel ones too, which
//         begin at a part of any place and whose ends come nearer as they go. Where entries differ by less
//         than the widening either may come first, and a part may be named that the ray misses by that
//         much; never the other way round.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "layout/odprt.layout.h"
#include "support/run_kernel.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 41;
constexpr std::size_t kCells = 96, kParts = 12, kSteps = 16;
// Parts' numbers: few of many.
constexpr layout::u32 kEvery = 157, kAll = kParts * kEvery;
static_assert(kAll <= KDRAY_MAX_PARTS);

struct RouteRay {
  float o[3], d[3], t_min, t_max;
  layout::u32 first;  // the part that it begins at, or KDRAY_NO_PART
  float shrink;       // a part that is asked leaves so much of the way
  layout::u32 pad[2];
};
struct Batch {  // sixteen rays and the directory that they are asked about
  layout::PartCell cells[kCells];
  RouteRay rays[16];
};
struct Answer {
  layout::u32 part[kSteps][16];  // as rays go
  float t_max[kSteps][16];       // as they ask it
  layout::u32 around[16];        // of the origins
};

constexpr layout::u32 kOwn = 2 * kEvery;  // a part with cells

const char* const kSource = R"(
#define KDRAY_ODPRT 1
#include "odprt/route.clh"
typedef struct RouteRay { float o[3], d[3], t_min, t_max; u32 first; float shrink; u32 pad[2]; } RouteRay;
typedef struct Batch { PartCell cells[96]; RouteRay rays[16]; } Batch;
typedef struct Answer { u32 part[16][16]; float t_max[16][16]; u32 around[16]; } Answer;
__kernel void test(__global const Batch* in, __global Answer* out, uint n) {
  const u32 i = (u32)get_global_id(0);
  if (i >= n) return;
  float f[9][16];
  u32 first[16];
  for (int k = 0; k < 16; ++k) {
    for (int a = 0; a < 3; ++a) f[a][k] = in[i].rays[k].o[a], f[3 + a][k] = in[i].rays[k].d[a];
    f[6][k] = in[i].rays[k].t_min, f[7][k] = in[i].rays[k].t_max, f[8][k] = in[i].rays[k].shrink;
    first[k] = in[i].rays[k].first;
  }
  const Directory directory = {in[i].cells, 96, 16.0f};
  const Real3xN o = {vload16(0, f[0]), vload16(0, f[1]), vload16(0, f[2])};
  const Real3xN d = {vload16(0, f[3]), vload16(0, f[4]), vload16(0, f[5])};
  const uint16 begun = vload16(0, first);
  Way way = no_way();
  way.parts = begun == KDRAY_NO_PART ? (uint16)(0u) : encoded_part(begun);
  float16 t_max = vload16(0, f[7]);
  for (u32 step = 0; step < 16; ++step) {
    float16 entry;
    const uint16 part = next_part(&directory, (int16)(-1), o, d, vload16(0, f[6]), t_max, &way,
                                  KDRAY_NO_PART, &entry);
    vstore16(part, 0, out[i].part[step]);
    vstore16(t_max, 0, out[i].t_max[step]);
    move_on(&way, entry, part);
    t_max = fmax(vload16(0, f[6]), t_max * vload16(0, f[8]));
  }
  vstore16(part_around(&directory, (int16)(-1), o, 314), 0, out[i].around);
}
)";

layout::PartCell bounds_of(const layout::PartCell* first, const layout::PartCell* end) {
  layout::PartCell bounds = *first;
  for (const layout::PartCell* cell = first; cell != end; cell += 1 + cell->n_below)
    for (int k = 0; k < 3; ++k) {
      bounds.lo[k] = std::min(bounds.lo[k], cell->lo[k]);
      bounds.hi[k] = std::max(bounds.hi[k], cell->hi[k]);
    }
  return bounds;
}

// Makes the first of [first, end), which are of one part, the bounds of all behind it; and so on among those,
// at random.
void put_in_a_tree(layout::PartCell* first, layout::PartCell* end, std::mt19937_64& random) {
  if (end - first < 2) return;
  layout::PartCell* middle =
      first + 1 + static_cast<std::ptrdiff_t>(random() % static_cast<std::uint64_t>(end - first));
  if (random() % 3 == 0) middle = end;  // all in one
  put_in_a_tree(first + 1, middle, random);
  put_in_a_tree(middle, end, random);
  *first = bounds_of(first + 1, end);
  first->n_below = static_cast<layout::u32>(end - first - 1);
}

void put_in_trees(layout::PartCell (&cells)[kCells], std::mt19937_64& random) {
  for (layout::PartCell* first = cells; first != cells + kCells;) {
    layout::PartCell* end = first + 1;
    while (end != cells + kCells && end->part == first->part) ++end;
    put_in_a_tree(first, end, random);
    first = end;
  }
}

Batch random_batch(std::mt19937_64& random) {
  std::uniform_real_distribution<float> place(-8, 8), size(0, 8);
  Batch batch{};
  for (std::size_t i = 0; i < kCells; ++i) {
    layout::PartCell& cell = batch.cells[i];
    for (int k = 0; k < 3; ++k) {
      cell.lo[k] = std::round(place(random));
      cell.hi[k] = cell.lo[k] + (random() % 5 == 0 ? 0.0f : size(random));
    }
    cell.part = static_cast<layout::u32>(i * kParts / kCells * kEvery);  // eight cells each
  }
  put_in_trees(batch.cells, random);
  for (RouteRay& r : batch.rays) {
    for (int k = 0; k < 3; ++k) {
      r.o[k] = random() % 4 == 0 ? std::round(place(random)) : place(random);
      r.d[k] = random() % 4 == 0 ? 0.0f : place(random);
    }
    if (r.d[0] == 0 && r.d[1] == 0 && r.d[2] == 0) r.d[random() % 3] = random() % 2 ? 1.0f : -1.0f;
    r.t_min = random() % 3 == 0 ? 0.3f : 0.0f;
    r.t_max = random() % 2 ? INFINITY : std::abs(place(random));
    r.first = random() % 3 ? static_cast<layout::u32>(random() % kParts) * kEvery : KDRAY_NO_PART;
    r.shrink = random() % 2 ? 1.0f : 0.9f;
  }
  return batch;
}

// Where the ray enters the cell, widened by `widen` on all sides; NaN where it doesn't.
double entry(const RouteRay& r, const layout::PartCell& cell, double widen) {
  double enter = r.t_min, leave = r.t_max;
  for (int k = 0; k < 3; ++k) {
    const double lo = cell.lo[k] - widen - r.o[k], hi = cell.hi[k] + widen - r.o[k];
    if (r.d[k] == 0) {
      if (lo > 0 || hi < 0) return NAN;
      continue;
    }
    enter = std::max(enter, std::min(lo / r.d[k], hi / r.d[k]));
    leave = std::min(leave, std::max(lo / r.d[k], hi / r.d[k]));
  }
  return enter <= leave ? enter : NAN;
}

constexpr double kWiden = 0x1p-14;  // more than the kernel's, 2^-19 of (|o| + 16)

// The first entry of each part, or NaN.
std::array<double, kParts> entries(const Batch& batch, const RouteRay& r, double widen) {
  std::array<double, kParts> first;
  first.fill(NAN);
  for (const layout::PartCell& cell : batch.cells) {
    if (cell.n_below > 0) continue;  // bounds of those behind it
    const double t = entry(r, cell, widen);
    double& of_part = first[cell.part / kEvery];
    if (!std::isnan(t) && !(of_part <= t)) of_part = t;
  }
  return first;
}

struct Counts {
  int asked = 0, passed = 0;
};

void check_way(const Batch& batch, const Answer& answer, std::size_t k, Counts& counts) {
  const RouteRay& r = batch.rays[k];
  const auto exact = entries(batch, r, 0), wide = entries(batch, r, kWiden);
  std::set<std::size_t> asked;
  if (r.first != KDRAY_NO_PART) asked.insert(r.first / kEvery);
  double before = 0;
  for (std::size_t step = 0; step < kSteps; ++step) {
    const layout::u32 number = answer.part[step][k];
    const double t_max = answer.t_max[step][k];
    if (number == KDRAY_NO_PART) {
      for (std::size_t part = 0; part < kParts; ++part)
        EXPECT_FALSE(exact[part] <= t_max && !asked.contains(part)) << "misses part " << part;
      return;
    }
    ASSERT_EQ(number % kEvery, 0u);
    const std::size_t part = number / kEvery;
    ASSERT_LT(part, kParts);
    EXPECT_TRUE(asked.insert(part).second) << "asks part " << part << " again";
    EXPECT_LE(wide[part], t_max) << "asks part " << part << ", which it doesn't meet";
    // No later than any that is left, and no earlier than the last.
    for (std::size_t other = 0; other < kParts; ++other) {
      if (!asked.contains(other) && exact[other] <= t_max) {
        EXPECT_LE(wide[part], exact[other]) << "passes over " << other;
      }
    }
    EXPECT_GE(std::isnan(exact[part]) ? INFINITY : exact[part], before);
    before = wide[part];
    ++counts.asked;
    counts.passed += static_cast<int>(asked.size() > 4);
  }
  FAIL() << "no end";
}

TEST(Route, EachPartOnceInTheOrderOfEntries) {
  std::mt19937_64 random(kSeed);
  std::vector<Batch> batches(1000);
  for (Batch& batch : batches) batch = random_batch(random);
  const auto answers = run_kernel<Answer>("cpu", kSource, batches);
  Counts counts;
  for (std::size_t b = 0; b < batches.size(); ++b)
    for (std::size_t k = 0; k < 16; ++k) {
      SCOPED_TRACE("batch " + std::to_string(b) + " ray " + std::to_string(k));
      check_way(batches[b], answers[b], k, counts);
    }
  EXPECT_GT(counts.asked, 5000);
  EXPECT_GT(counts.passed, 100) << "few rays ask many";
}

bool lies_in(const RouteRay& r, const layout::PartCell& cell) {
  for (int k = 0; k < 3; ++k)
    if (r.o[k] < cell.lo[k] || r.o[k] > cell.hi[k]) return false;
  return true;
}

// Moves a ray's origin into a cell, or onto its faces.
void put_into(const layout::PartCell& cell, std::mt19937_64& random, RouteRay& r) {
  for (int k = 0; k < 3; ++k) {
    const float share = 0.25f * static_cast<float>(random() % 5);
    r.o[k] = std::min(cell.lo[k] + share * (cell.hi[k] - cell.lo[k]), cell.hi[k]);
  }
}

TEST(Route, TheOtherPartAroundAPoint) {
  std::mt19937_64 random(kSeed + 1);
  std::vector<Batch> batches(400);
  for (Batch& batch : batches) {
    batch = random_batch(random);
    for (RouteRay& r : batch.rays)
      if (random() % 2) put_into(batch.cells[random() % kCells], random, r);
  }
  const auto answers = run_kernel<Answer>("cpu", kSource, batches);
  int n_inside = 0, n_outside = 0;
  for (std::size_t b = 0; b < batches.size(); ++b)
    for (std::size_t k = 0; k < 16; ++k) {
      std::vector<layout::u32> around;
      for (const layout::PartCell& cell : batches[b].cells)
        if (cell.n_below == 0 && cell.part != kOwn && lies_in(batches[b].rays[k], cell))
          around.push_back(cell.part);
      const layout::u32 part = answers[b].around[k];
      const bool right = around.empty() ? part == KDRAY_NO_PART
                                        : std::find(around.begin(), around.end(), part) != around.end();
      EXPECT_TRUE(right) << "batch " << b << " point " << k << ": part " << part;
      ++(around.empty() ? n_outside : n_inside);
    }
  EXPECT_GT(n_inside, 300);
  EXPECT_GT(n_outside, 300);
}

}  // namespace
}  // namespace kdray::test
