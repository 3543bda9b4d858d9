#include "base/timeline.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace kdray::timeline {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMicroseconds = 1e6;

Json row_name(int row, const std::string& name) {
  return {{"name", "thread_name"}, {"ph", "M"}, {"pid", 0}, {"tid", row}, {"args", {{"name", name}}}};
}

Json event(const Span& span) {
  Json numbers = Json::object();
  for (const auto& [name, value] : span.numbers) numbers[name] = value;
  return {{"name", span.name},
          {"ph", "X"},
          {"pid", 0},
          {"tid", span.row},
          {"ts", span.start * kMicroseconds},
          {"dur", (span.end - span.start) * kMicroseconds},
          {"args", std::move(numbers)}};
}

}  // namespace

void Timeline::name_row(int row, const std::string& name) {
  const std::lock_guard lock(mutex_);
  rows_.emplace_back(row, name);
}

void Timeline::add(int row, const std::string& name, double start, double end, Numbers numbers) {
  const std::lock_guard lock(mutex_);
  spans_.push_back({row, name, start, end, std::move(numbers)});
}

std::vector<Span> Timeline::spans(int row) const {
  const std::lock_guard lock(mutex_);
  std::vector<Span> of_row;
  std::copy_if(spans_.begin(), spans_.end(), std::back_inserter(of_row),
               [row](const Span& span) { return span.row == row; });
  std::stable_sort(of_row.begin(), of_row.end(),
                   [](const Span& a, const Span& b) { return a.start < b.start; });
  return of_row;
}

std::string Timeline::json() const {
  const std::lock_guard lock(mutex_);
  Json events = Json::array();
  for (const auto& [row, name] : rows_) events.push_back(row_name(row, name));
  for (const Span& span : spans_) events.push_back(event(span));
  return Json{{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}}.dump();
}

}  // namespace kdray::timeline
