// What    The part that a ray asks next (kernels/odprt/route.clh), on the device, against the definition in double: of the parts not
//         asked yet, the one whose first cell the ray enters first before its end.
// Shape   Random cells, also flat and touching ones, and rays of all kinds, axis-parallel ones too. Where entries differ by less than
//         the widening either may come first, and a part may be named that the ray misses by that much; never the other
//         way round.
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
  layout::u32 part[16];
};

const char* const kSource = R"(
#define KDRAY_ODPRT 1
#include "odprt/route.clh"
typedef struct RouteRay { float o[3], d[3], t_min, t_max; u32 visited[2], pad[2]; } RouteRay;
typedef struct Batch { PartCell cells[40]; RouteRay rays[16]; } Batch;
typedef struct Answer { u32 part[16]; } Answer;
__kernel void test(__constant const Batch* in, __global Answer* out, uint n) {
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
  vstore16(next_part(&directory, (int16)(-1), o, d, vload16(0, f[6]), vload16(0, f[7]), visited), 0, out[i].part);
}
)";

// Makes the first cell of each part that has several their bounds.
void put_bounds_first(layout::PartCell (&cells)[kCells]) {
  for (std::size_t first = 0; first < kCells;) {
    std::size_t end = first + 1;
    for (; end < kCells && cells[end].part == cells[first].part; ++end)
      for (int k = 0; k < 3; ++k) {
        cells[first].lo[k] =
            end == first + 1 ? cells[end].lo[k] : std::min(cells[first].lo[k], cells[end].lo[k]);
        cells[first].hi[k] =
            end == first + 1 ? cells[end].hi[k] : std::max(cells[first].hi[k], cells[end].hi[k]);
      }
    cells[first].n_cells = static_cast<layout::u32>(end - first - 1);
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
    cell.part = static_cast<layout::u32>(i * kParts / kCells / 3 * 3);  // one to three cells each
  }
  put_bounds_first(batch.cells);
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
    if (cell.n_cells > 0) continue;  // a part's bounds
    const double t = entry(r, cell, widen);
    if (!was_asked(r, cell.part) && !std::isnan(t) && !(first[cell.part] <= t)) first[cell.part] = t;
  }
  return first;
}

TEST(Route, TheFirstPartNotAskedYet) {
  std::mt19937_64 random(kSeed);
  std::vector<Batch> batches(400);
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

}  // namespace
}  // namespace kdray::test
