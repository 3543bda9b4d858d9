#include "stress/table.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

namespace kdray::stress {

namespace {

constexpr double kQuickRays = 6e6, kFullRays = 1e9;

struct Table {
  std::mutex mutex;
  std::vector<Row> rows;
  std::vector<Errors> errors;
};

Table& table() {
  static Table all;
  return all;
}

double budget() {
  const char* value = std::getenv("KDRAY_STRESS");
  if (value == nullptr || *value == 0) return kQuickRays;
  if (std::string(value) == "full") return kFullRays;
  char* end = nullptr;
  const double rays = std::strtod(value, &end);
  if (*end != 0 || !(rays >= 1)) {
    std::fprintf(stderr, "KDRAY_STRESS=%s: give a number of rays, or full\n", value);
    std::exit(2);
  }
  return rays;
}

void print_rows(const std::vector<Row>& rows) {
  if (rows.empty()) return;
  fmt::print("\n{:<10} {:<42} {:<8} {:>14} {:>7} {:>10}\n", "figure", "family", "walk", "rays", "wrong",
             "excepted");
  for (const Row& r : rows)
    fmt::print("{:<10} {:<42} {:<8} {:>14} {:>7} {:>10}\n", r.figure, r.family, r.traversal, r.rays, r.wrong,
               r.exceptions);
}

// The sums over families and walks.
std::vector<Row> totals_of(const std::vector<Row>& rows) {
  std::vector<Row> totals;
  for (const Row& r : rows) {
    auto total =
        std::find_if(totals.begin(), totals.end(), [&](const Row& t) { return t.figure == r.figure; });
    if (total == totals.end()) total = totals.insert(total, Row{r.figure, "all", "all"});
    total->rays += r.rays, total->wrong += r.wrong, total->exceptions += r.exceptions;
  }
  return totals;
}

void print_errors(const std::vector<Errors>& errors) {
  if (errors.empty()) return;
  fmt::print("\n{:<42} {:>9} {:>12} {:>14} {:>12} {:>8}\n", "worst errors, ulps", "samples", "t", "t, facing",
             "point", "of bound");
  for (const Errors& e : errors)
    fmt::print("{:<42} {:>9} {:>12.4g} {:>14.4g} {:>12.4g} {:>8.3f}\n", e.family, e.samples, e.t_ulps,
               e.t_facing_ulps, e.point_ulps, e.share_of_bound);
}

nlohmann::json to_json(const std::vector<Row>& rows) {
  nlohmann::json all = nlohmann::json::array();
  for (const Row& r : rows)
    all.push_back({{"figure", r.figure},
                   {"family", r.family},
                   {"traversal", r.traversal},
                   {"rays", r.rays},
                   {"wrong", r.wrong},
                   {"exceptions", r.exceptions}});
  return all;
}

nlohmann::json to_json(const std::vector<Errors>& errors) {
  nlohmann::json all = nlohmann::json::array();
  for (const Errors& e : errors)
    all.push_back({{"family", e.family},
                   {"samples", e.samples},
                   {"t_ulps", e.t_ulps},
                   {"t_facing_ulps", e.t_facing_ulps},
                   {"point_ulps", e.point_ulps},
                   {"share_of_bound", e.share_of_bound}});
  return all;
}

class PrintAtTheEnd : public testing::Environment {
  void TearDown() override {
    const std::vector<Row> totals = totals_of(table().rows);
    print_rows(table().rows);
    print_rows(totals);
    print_errors(table().errors);
    std::fflush(stdout);
    const char* file = std::getenv("KDRAY_STRESS_JSON");
    if (file == nullptr || *file == 0) return;
    const nlohmann::json all{{"rays_asked_for", budget()},
                             {"totals", to_json(totals)},
                             {"families", to_json(table().rows)},
                             {"errors", to_json(table().errors)}};
    std::ofstream out(file);
    out << all.dump(1) << '\n';
    EXPECT_TRUE(out.good()) << file;
  }
};

const auto* const registered = testing::AddGlobalTestEnvironment(new PrintAtTheEnd);

}  // namespace

void add(const Row& row) {
  const std::lock_guard lock(table().mutex);
  table().rows.push_back(row);
}

void add(const Errors& errors) {
  const std::lock_guard lock(table().mutex);
  table().errors.push_back(errors);
}

bool is_full() {
  return std::getenv("KDRAY_STRESS") != nullptr;
}

std::uint64_t rays_to_trace(double share) {
  return std::max(std::uint64_t{1000}, static_cast<std::uint64_t>(share * budget()));
}

}  // namespace kdray::stress
