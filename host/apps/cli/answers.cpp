#include "apps/cli/answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/query/queries.h"

namespace kdray::cli {

namespace {

using array::Column;
using array::column;

template <class T>
Column column_of(const char* name, const std::vector<T>& values) {
  return column(name, std::span<const T>(values));
}

// As the hits of float rays have it: -1 is a miss.
Column signed_column(const char* name, const std::vector<std::uint32_t>& values) {
  return column(name, std::span(reinterpret_cast<const std::int32_t*>(values.data()), values.size()));
}
static_assert(static_cast<std::int32_t>(kNoPrimitive) == -1);

static_assert(static_cast<std::int32_t>(kNoInstance) == -1);

// Scenes without instances have no such column.
std::vector<Column> with_instances(std::vector<Column> columns, bool placed,
                                   const std::vector<std::uint32_t>& instances) {
  if (placed) columns.push_back(signed_column("instance", instances));
  return columns;
}

constexpr double kMiss = std::numeric_limits<double>::infinity();

template <class T, class Holds>
std::uint64_t count_if(const std::vector<T>& values, const Holds& holds) {
  return static_cast<std::uint64_t>(std::count_if(values.begin(), values.end(), holds));
}

}  // namespace

std::vector<Column> columns_of(std::span<const Hit> hits, const std::vector<std::uint32_t>& instances) {
  return with_instances({column("t", hits, &Hit::t), column("primitive", hits, &Hit::primitive),
                         column("u", hits, &Hit::u), column("v", hits, &Hit::v)},
                        !instances.empty(), instances);
}

void Answers::ask(const query::QueryContext& scene, const RequestedRows& rows, std::size_t n) {
  placed_ = scene.table.has_instances();
  switch (question_) {
    case Question::closest:
      return ask_closest(scene, rows.rays(n), n);
    case Question::any:
      return ask_any(scene, rows.rays(n), n);
    case Question::all:
      return ask_all(scene, rows.rays(n), n);
    case Question::count:
      counts_.resize(n);
      query::count(scene, rows.rays(n), counts_, {});
      return;
    case Question::closest_point:
      return ask_closest_point(scene, rows.points(n), n);
    case Question::signed_distance:
      t_.resize(n);
      query::signed_distance(scene, rows.points(n), t_, {});
      return;
    case Question::inside:
      flags_.resize(n);
      query::inside(scene, rows.points(n), flags_, {});
      return;
  }
}

void Answers::ask_closest(const query::QueryContext& scene, const Rays& rays, std::size_t n) {
  t_.resize(n), primitive_.resize(n), u_.resize(n), v_.resize(n);
  if (placed_) instance_.resize(n);
  query::closest(scene, rays, {.t = t_, .primitive = primitive_, .u = u_, .v = v_, .instance = instance_},
                 {});
}

// What a Renderer tells of any hit: t is 0, and nothing of where it is.
void Answers::ask_any(const query::QueryContext& scene, const Rays& rays, std::size_t n) {
  flags_.resize(n);
  query::any(scene, rays, flags_, {});
  t_.resize(n);
  std::transform(flags_.begin(), flags_.end(), t_.begin(),
                 [](std::uint8_t hit) { return hit ? 0.0 : kMiss; });
  primitive_.assign(n, kNoPrimitive), u_.assign(n, 0), v_.assign(n, 0);
  if (placed_) instance_.assign(n, kNoInstance);
}

void Answers::ask_all(const query::QueryContext& scene, const Rays& rays, std::size_t) {
  AllHitsOptions options;
  options.max_hits = max_hits_;
  all_ = query::all(scene, rays, options);
  if (placed_) instance_ = all_.instance;
}

void Answers::ask_closest_point(const query::QueryContext& scene, const Points& points, std::size_t n) {
  t_.resize(n), point_.resize(n), geometry_.resize(n), primitive_.resize(n), u_.resize(n), v_.resize(n);
  if (placed_) instance_.resize(n);
  query::closest_points(scene, points,
                        {.distance = t_,
                         .point = point_,
                         .geometry = geometry_,
                         .primitive = primitive_,
                         .u = u_,
                         .v = v_,
                         .instance = instance_},
                        {});
}

std::vector<Column> Answers::columns() const {
  switch (question_) {
    case Question::closest:
    case Question::any:
      return with_instances({column_of("t", t_), signed_column("primitive", primitive_), column_of("u", u_),
                             column_of("v", v_)},
                            placed_, instance_);
    case Question::all:
      return with_instances({column_of("splits", all_.splits), column_of("t", all_.t),
                             column_of("geometry", all_.geometry), column_of("primitive", all_.primitive),
                             column_of("u", all_.u), column_of("v", all_.v), array::flags("more", all_.more)},
                            placed_, instance_);
    case Question::count:
      return {column_of("count", counts_)};
    case Question::closest_point:
      return with_instances(
          {column_of("distance", t_), column("point", std::span<const std::array<double, 3>>(point_)),
           column_of("geometry", geometry_), column_of("primitive", primitive_), column_of("u", u_),
           column_of("v", v_)},
          placed_, instance_);
    case Question::signed_distance:
      return {column_of("distance", t_)};
    case Question::inside:
      return {array::flags("inside", flags_)};
  }
  return {};
}

std::uint64_t Answers::n_found() const {
  switch (question_) {
    case Question::closest:
    case Question::closest_point:
      return count_if(primitive_, [](std::uint32_t primitive) { return primitive != kNoPrimitive; });
    case Question::any:
    case Question::inside:
      return count_if(flags_, [](std::uint8_t flag) { return flag != 0; });
    case Question::all:
      return all_.t.size();
    case Question::count:
      return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
    case Question::signed_distance:
      return count_if(t_, [](double distance) { return distance < 0; });
  }
  return 0;
}

}  // namespace kdray::cli
