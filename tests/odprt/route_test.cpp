// What    The part that a ray asks next (kernels/odprt/route.clh), on the device, against the definition in
//         double: of the parts not asked yet, the one whose first cell the ray enters first before its end.
// Shape   Random cells, also flat and touching ones, and rays of all kinds, axis-parallel ones too. Where
//         entries differ by less than the widening either may come first, and a part may be named that the
//         ray misses by that much; never the other way round.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "layout/odprt.layout.h"
#include "support/run_kernel.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 41;
constexpr std::size_t kCells = 40, kParts = 64;

struct RouteRay {
  float o[3], d[3], t_min, t_max;
  layout::u32 visited[2], pad[2];
};
struct Batch {  // sixteen rays and the directory that they are asked about
  layout::PartCell cells[kCells];
  RouteRay rays[16];
};
struct Answer {
  layout::u32 part[16], around[16];  // of the origins
};

constexpr layout::u32 kOwn = 24;  // a part with cells

const char* const kSource = R"(
#define KDRAY_ODPRT 1
#include "odprt/route.clh"
typedef struct RouteRay { float o[3], d[3], t_min, t_max; u32 visited[2], pad[2]; } RouteRay;
typedef struct Batch { PartCell cells[40]; RouteRay rays[16]; } Batch;
typedef struct Answer { u32 part[16], around[16]; } Answer;
__kernel void test(__global const Batch* in, __global Answer* out, uint n) {
  const u32 i = (u32)get_global_id(0);
  if (i >= n) return;
  float f[8][16];
  u32 v[2][16];
  for (int k = 0; k < 16; ++k) {
    for (int a = 0; a < 3; ++a) f[a][k] = in[i].rays[k].o[a], f[3 + a][k] = in[i].rays[k].d[a];
    f[6][k] = in[i].rays[k].t_min, f[7][k] = in[i].rays[k].t_max;
    for (int a = 0; a < 2; ++a) v[a][k] = in[i].rays[k].visited[a];
  }
  const Directory directory = {in[i].cells, 40, 16.0f};
  const Real3x16 o = {vload16(0, f[0]), vload16(0, f[1]), vload16(0, f[2])};
  const Real3x16 d = {vload16(0, f[3]), vload16(0, f[4]), vload16(0, f[5])};
  const Visited visited = {vload16(0, v[0]), vload16(0, v[1])};
  const uint16 part =
      next_part(&directory, (int16)(-1), o, d, vload16(0, f[6]), vload16(0, f[7]), visited);
  vstore16(part, 0, out[i].part);
  vstore16(part_around(&directory, (int16)(-1), o, 24), 0, out[i].around);
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
  std::uniform_real_distribution<float> place(-8, 8), size(0, 4);
  Batch batch{};
  for (std::size_t i = 0; i < kCells; ++i) {
    layout::PartCell& cell = batch.cells[i];
    for (int k = 0; k < 3; ++k) {
      cell.lo[k] = std::round(place(random));
      cell.hi[k] = cell.lo[k] + (random() % 5 == 0 ? 0.0f : size(random));
    }
    cell.part = static_cast<layout::u32>(i * kParts / kCells / 12 * 12);  // seven or eight cells each
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
    for (layout::u32& word : r.visited) word = random() % 2 ? 0 : static_cast<layout::u32>(random());
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

bool was_asked(const RouteRay& r, layout::u32 part) {
  return r.visited[part / 32] >> (part % 32) & 1u;
}

constexpr double kWiden = 0x1p-14;  // more than the kernel's, 2^-19 of (|o| + 16)

// The first entry of each part, or NaN.
std::array<double, kParts> entries(const Batch& batch, const RouteRay& r, double widen) {
  std::array<double, kParts> first;
  first.fill(NAN);
  for (const layout::PartCell& cell : batch.cells) {
    if (cell.n_below > 0) continue;  // bounds of those behind it
    const double t = entry(r, cell, widen);
    if (!was_asked(r, cell.part) && !std::isnan(t) && !(first[cell.part] <= t)) first[cell.part] = t;
  }
  return first;
}

TEST(Route, TheFirstPartNotAskedYet) {
  std::mt19937_64 random(kSeed);
  std::vector<Batch> batches(1000);
  for (Batch& batch : batches) batch = random_batch(random);
  const auto answers = run_kernel<Answer>("cpu", kSource, batches);
  int n_found = 0, n_none = 0;
  for (std::size_t b = 0; b < batches.size(); ++b)
    for (std::size_t k = 0; k < 16; ++k) {
      const RouteRay& r = batches[b].rays[k];
      const auto exact = entries(batches[b], r, 0), wide = entries(batches[b], r, kWiden);
      double nearest = INFINITY;
      for (const double t : exact)
        if (t < nearest) nearest = t;
      const layout::u32 part = answers[b].part[k];
      if (part == KDRAY_NO_PART) {
        ++n_none;
        EXPECT_EQ(nearest, INFINITY) << "batch " << b << " ray " << k << " misses a part";
        continue;
      }
      ++n_found;
      ASSERT_LT(part, kParts);
      EXPECT_FALSE(was_asked(r, part));
      ASSERT_FALSE(std::isnan(wide[part]))
          << "batch " << b << " ray " << k << " asks a part that it doesn't meet";
      EXPECT_LE(wide[part], nearest) << "batch " << b << " ray " << k << " passes over a nearer part";
    }
  EXPECT_GT(n_found, 500);
  EXPECT_GT(n_none, 300);
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
