#include "bench/build/report.h"

#include <array>

namespace kdray::bench {

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
