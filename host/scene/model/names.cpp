#include "scene/model/names.h"

#include <algorithm>

#include "scene/import/text_scanner.h"

namespace kdray::scene {

namespace {

constexpr std::size_t kLongest = 200;
const std::string kUnnamed;

std::uint32_t name_at(const std::vector<NameRun>& runs, std::uint32_t number) {
  const auto next = std::ranges::upper_bound(runs, number, {}, &NameRun::first);
  return next == runs.begin() ? 0 : std::prev(next)->name;
}

}  // namespace

const std::string& Names::text(std::uint32_t name) const {
  return name < texts.size() ? texts[name] : kUnnamed;
}
const std::string& Names::of_material(std::uint32_t number) const {
  return number < materials.size() ? text(materials[number]) : kUnnamed;
}
const std::string& Names::of_primitive(std::uint32_t number) const {
  return text(name_at(primitives, number));
}
const std::string& Names::of_instance(std::uint32_t number) const {
  return text(name_at(instances, number));
}

std::uint64_t Names::bytes() const {
  std::uint64_t bytes = materials.size() * sizeof(std::uint32_t) + texts.size() * sizeof(std::string) +
                        (primitives.size() + instances.size()) * sizeof(NameRun);
  for (const std::string& text : texts) bytes += text.size();
  return bytes;
}

std::uint32_t NameTable::add(std::string_view text) {
  if (names_.texts.empty()) names_.texts.emplace_back();
  if (text.empty()) return 0;
  const auto [it, added] =
      numbers_.try_emplace(printable(text, kLongest), static_cast<std::uint32_t>(names_.texts.size()));
  if (added) names_.texts.push_back(it->first);
  return it->second;
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
