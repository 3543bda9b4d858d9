// A ray that begins and ends outside of a closed mesh crosses it an even number of times: by Scene::count(),
// for ten meshes at all scales and places, rays in double and in float. In full 1e8 rays.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "engine/query/meshes.h"
#include "stress/lines.h"
#include "stress/table.h"
#include "stress/traced.h"
#include "support/device.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 11;
constexpr double kShare = 0.1;  // of the suite's rays
constexpr std::size_t kChunk = std::size_t{1} << 20;

std::vector<Line> make_lines(const ClosedShape& shape, const LineFamily& family, std::uint64_t first,
                             std::size_t n) {
  std::vector<Line> lines(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      Random random(kSeed, first + i);
      lines[i] = family.make(shape, random);
    }
  });
  return lines;
}

struct FloatLine {
  vec3 origin, direction;
};

// Of an array of structs, of doubles or of floats.
template <class AnyLine>
Rays rays_of(const std::vector<AnyLine>& lines) {
  const std::size_t stride = sizeof(AnyLine);
  return {{&lines.data()->origin.x, lines.size(), stride},
          {&lines.data()->direction.x, lines.size(), stride}};
}

// The parameter is the shape's place among the ten.
class ParityOf : public testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    if (test::usable_devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }

  void expect_even(const Scene& scene, const Rays& rays, const std::vector<Line>& lines, const char* family,
                   Row& row) {
    std::vector<std::uint32_t> counts(lines.size());
    scene.count(rays, counts);
    std::vector<std::uint8_t> any(lines.size());
    scene.any(rays, any);
    row.rays += lines.size();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      // What is crossed is met; but not all that is met is crossed.
      if (counts[i] % 2 == 0 && (counts[i] == 0 || any[i] == 1)) continue;
      if (row.wrong++ < 3)
        ADD_FAILURE() << "seed " << kSeed << ", ray " << i << " of " << family << " in " << row.traversal
                      << " has " << counts[i] << " crossings, any: " << int{any[i]} << ": "
                      << in_words(lines[i]);
    }
  }

  // Half of them as doubles and half as floats: where the place is far off these are other rays than the
  // doubles, and none of them begins inside.
  void ask(const Scene& scene, const ClosedShape& shape, const LineFamily& family, std::uint64_t first,
           std::size_t n) {
    const std::vector<Line> lines = make_lines(shape, family, first, n);
    expect_even(scene, rays_of(lines), lines, family.name, in_double_);
    const std::vector<Line> others = make_lines(shape, family, first + n, n);
    std::vector<FloatLine> floats(n);
    for (std::size_t i = 0; i < n; ++i) floats[i] = {vec3(others[i].origin), vec3(others[i].direction)};
    expect_even(scene, rays_of(floats), others, family.name, in_float_);
  }

  Row in_double_{"parity", "", "double"}, in_float_{"parity", "", "float"};
};

std::string name_of_shape(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = ten_closed_shapes()[info.param].name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(ClosedMeshes, ParityOf, testing::Range(std::size_t{0}, kClosedShapes),
                         name_of_shape);

TEST_P(ParityOf, CountIsEven) {
  const ClosedShape original = ten_closed_shapes()[GetParam()];
  in_double_.family = in_float_.family = original.name;
  const double all = static_cast<double>(rays_to_trace(1)) * kShare;
  const auto n = static_cast<std::size_t>(all / static_cast<double>(n_placed() * kLineFamilies.size()) / 2);
  std::uint64_t number = GetParam() << 16;
  for (const Place& place : places(GetParam())) {
    SCOPED_TRACE(original.name + ", " + in_words(place));
    const ClosedShape shape = placed(original, place);
    const Scene scene = committed(shape);
    ASSERT_TRUE(test::edges_are_even(scene.model()));
    for (const LineFamily& family : kLineFamilies)
      ask(scene, shape, family, ++number * kChunk, std::max<std::size_t>(n, 32));
  }
  add(in_double_);
  add(in_float_);
}

}  // namespace
}  // namespace kdray::stress
