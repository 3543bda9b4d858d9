#include "scene/model/names.h"

#include <algorithm>
#include <functional>

#include "scene/import/text_scanner.h"

namespace kdray::scene {

namespace {

constexpr std::size_t kLongest = 200;

std::uint32_t name_at(const std::vector<NameRun>& runs, std::uint32_t number) {
  const auto next = std::ranges::upper_bound(runs, number, {}, &NameRun::first);
  return next == runs.begin() ? 0 : std::prev(next)->name;
}

}  // namespace

std::string_view Names::text(std::uint32_t name) const {
  if (name == 0 || name >= ends.size()) return {};
  const std::uint32_t begin = ends[name - 1], end = ends[name];
  return begin <= end && end <= texts.size() ? std::string_view(texts).substr(begin, end - begin)
                                             : std::string_view();
}
std::string_view Names::of_material(std::uint32_t number) const {
  return number < materials.size() ? text(materials[number]) : std::string_view();
}
std::string_view Names::of_primitive(std::uint32_t number) const {
  return text(name_at(primitives, number));
}
std::string_view Names::of_instance(std::uint32_t number) const {
  return text(name_at(instances, number));
}

std::uint64_t Names::bytes() const {
  return texts.size() + (ends.size() + materials.size()) * sizeof(std::uint32_t) +
         (primitives.size() + instances.size()) * sizeof(NameRun);
}

// Returns where the name stands, or is to stand.
std::uint32_t& NameTable::place_of(std::string_view text) {
  std::size_t i = std::hash<std::string_view>()(text) % table_.size();
  while (table_[i] != 0 && names_.text(table_[i]) != text) i = (i + 1) % table_.size();
  return table_[i];
}

void NameTable::grow() {
  table_.assign(std::max<std::size_t>(64, 4 * names_.ends.size()), 0);
  for (std::uint32_t name = 1; name < names_.ends.size(); ++name) place_of(names_.text(name)) = name;
}

std::uint32_t NameTable::add(std::string_view text) {
  if (names_.ends.empty()) names_.ends.push_back(0);
  const std::string shown = printable(text, kLongest);
  if (shown.empty() || names_.texts.size() + shown.size() > 0xffffffffu) return 0;
  if (2 * (names_.ends.size() + 1) > table_.size()) grow();
  std::uint32_t& name = place_of(shown);
  if (name != 0) return name;
  name = static_cast<std::uint32_t>(names_.ends.size());
  names_.texts += shown;
  names_.ends.push_back(static_cast<std::uint32_t>(names_.texts.size()));
  return name;
}

void NameTable::name_material(std::uint32_t number, std::string_view text) {
  const std::uint32_t name = add(text);
  if (name == 0) return;
  if (names_.materials.size() <= number) names_.materials.resize(number + std::size_t{1}, 0);
  if (names_.materials[number] == 0) names_.materials[number] = name;  // of several, the first
}

void NameTable::begin(std::vector<NameRun>& runs, std::uint32_t first, std::uint32_t name) {
  if (!runs.empty() && runs.back().first == first) runs.pop_back();  // nothing had that name
  if (name != (runs.empty() ? 0 : runs.back().name)) runs.push_back({first, name});
}

std::shared_ptr<const Names> NameTable::finish(std::uint32_t n_primitives, std::uint32_t n_instances) {
  begin(names_.primitives, n_primitives, 0);
  begin(names_.instances, n_instances, 0);
  if (names_.primitives.empty() && names_.instances.empty() && names_.materials.empty()) return nullptr;
  return std::make_shared<const Names>(std::move(names_));
}

}  // namespace kdray::scene
