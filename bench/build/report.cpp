#include "bench/build/report.h"

#include <array>

namespace kdray::bench {

std::string color_of(std::size_t i, const std::string& name) {
  static constexpr std::array<const char*, 8> kColors = {"#f2c14e", "#c4504f", "#4e9bd4", "#5fb37a",
                                                         "#9a6fb0", "#f28e4e", "#8c6d46", "#d48fb8"};
  return name == kEmbreeBuilder ? "#7a7a7a" : kColors[i % kColors.size()];
}

Json json_of(const TreeFacts& t) {
  return {{"duplication", t.duplication}, {"sah_cost", t.sah_cost},         {"tight_cost", t.tight_cost},
          {"max_depth", t.max_depth},     {"binary_bytes", t.binary_bytes}, {"wide_bytes", t.wide_bytes}};
}

Json json_of(const BuildSpreads& s) {
  return {{"tree", json_of(s.tree)},
          {"flatten", json_of(s.flatten)},
          {"total", json_of(s.total)},
          {"cpu", json_of(s.cpu)}};
}

}  // namespace kdray::bench
