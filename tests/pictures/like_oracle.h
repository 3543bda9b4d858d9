// What    A picture held against the oracle's: every pixel within a quarter of an 8-bit step in linear RGB,
//         but for those whose ray tree takes another path a hundredth of a pixel aside; of these, few may
//         differ.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "kdray/kdray.h"
#include "oracle/oracle.h"

namespace kdray::test {

// A quarter of an 8-bit step; float and double are 1e-4 apart at the most.
inline constexpr double kTolerance = 1e-3;
inline constexpr double kDifferingEdges = 0.005;  // share of all pixels

struct PictureVerdict {
  int edges = 0, differing_edges = 0, wrong = 0;
  double worst = 0;  // of the pixels that are no edges
  int worst_x = 0, worst_y = 0;
  dvec3 found{0}, wanted{0};
};

inline PictureVerdict judge(const Picture& picture, const oracle::OracleResult& truth) {
  PictureVerdict v;
  for (std::size_t i = 0; i < truth.rgb.size(); ++i) {
    const dvec3 found(picture.rgb[3 * i], picture.rgb[3 * i + 1], picture.rgb[3 * i + 2]);
    const dvec3 apart = glm::abs(found - truth.rgb[i]);
    const double difference = std::max({apart.x, apart.y, apart.z});
    const bool differs = !(difference <= kTolerance);  // so that NaN differs
    v.edges += truth.edge[i];
    v.differing_edges += truth.edge[i] && differs;
    if (truth.edge[i]) continue;
    v.wrong += differs;
    if (difference <= v.worst) continue;
    v.worst = difference, v.found = found, v.wanted = truth.rgb[i];
    v.worst_x = static_cast<int>(i % truth.width), v.worst_y = static_cast<int>(i / truth.width);
  }
  return v;
}

inline void expect_like(const Picture& picture, const oracle::OracleResult& truth) {
  ASSERT_EQ(picture.width, truth.width);
  ASSERT_EQ(picture.height, truth.height);
  ASSERT_EQ(picture.rgb.size(), 3 * truth.rgb.size());
  const PictureVerdict v = judge(picture, truth);
  EXPECT_EQ(v.wrong, 0) << fmt::format(
      "worst at ({}, {}): {:.4f} {:.4f} {:.4f} instead of {:.4f} {:.4f} {:.4f}", v.worst_x, v.worst_y,
      v.found.x, v.found.y, v.found.z, v.wanted.x, v.wanted.y, v.wanted.z);
  EXPECT_LE(v.differing_edges, kDifferingEdges * truth.rgb.size());
  testing::Test::RecordProperty("edges", v.edges);
  testing::Test::RecordProperty("differing_edges", v.differing_edges);
  testing::Test::RecordProperty("worst", fmt::format("{:.6f}", v.worst));
}

}  // namespace kdray::test
