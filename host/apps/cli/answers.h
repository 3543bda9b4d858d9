// What    The answers to what kdray trace asks, as columns of a file (docs/cli.md has each one's type).
// Shape   Ask once, or several times to measure; the arrays serve again.
// Errors  kdray::Error, ErrorCode::input: the API's, for a ray or point that means nothing.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "api/committed.h"
#include "apps/cli/question.h"
#include "io/array/table.h"
#include "kdray/query.h"

namespace kdray::cli {

// The columns of hits that a Renderer has traced; `instances`: of each hit, in a scene that has some.
std::vector<array::Column> columns_of(std::span<const Hit> hits, const std::vector<std::uint32_t>& instances);

class Answers {
 public:
  Answers(Question question, std::uint32_t max_hits) : question_(question), max_hits_(max_hits) {}

  // About the first n rows.
  void ask(const query::QueryContext& scene, const RequestedRows& rows, std::size_t n);

  std::vector<array::Column> columns() const;
  // Rays that hit something, all hits, all crossings, points that something is near, or that lie inside.
  std::uint64_t n_found() const;

 private:
  void ask_any(const query::QueryContext& scene, const Rays& rays, std::size_t n);
  void ask_all(const query::QueryContext& scene, const Rays& rays, std::size_t n);
  void ask_closest(const query::QueryContext& scene, const Rays& rays, std::size_t n);
  void ask_closest_point(const query::QueryContext& scene, const Points& points, std::size_t n);

  Question question_;
  std::uint32_t max_hits_;

  std::vector<double> t_;  // or distances
  std::vector<std::array<double, 3>> point_;
  std::vector<std::uint32_t> geometry_, primitive_;  // a miss's primitive is -1 where that is signed
  bool placed_ = false;                              // the scene has instances
  std::vector<std::uint32_t> instance_;              // of each hit, where it has
  std::vector<float> u_, v_;
  std::vector<std::uint32_t> counts_;
  std::vector<std::uint8_t> flags_;
  AllHits all_;
};

}  // namespace kdray::cli
