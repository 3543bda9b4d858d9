// What    Counts what the reader of a text format leaves out: one warning of each kind, with the line of the
//         first and how many there were.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::scene {

class LeftOut {
 public:
  // `what` follows the number: "faces with fewer than 3 corners are left out".
  void add(std::string_view what, std::uint32_t line) {
    auto kind = std::ranges::find(kinds_, what, &Kind::what);
    if (kind == kinds_.end()) kind = kinds_.insert(kind, {std::string(what), 0, line});
    ++kind->count;
  }

  std::size_t count(std::string_view what) const {
    const auto kind = std::ranges::find(kinds_, what, &Kind::what);
    return kind == kinds_.end() ? 0 : kind->count;
  }

  void warn(const std::string& file, std::vector<std::string>& warnings) const {
    for (const Kind& kind : kinds_)
      warnings.push_back(file + ":" + std::to_string(kind.line) + ": " + std::to_string(kind.count) + " " +
                         kind.what + " (the first is in this line)");
  }

 private:
  struct Kind {
    std::string what;
    std::size_t count;
    std::uint32_t line;
  };
  std::vector<Kind> kinds_;  // by their first
};

}  // namespace kdray::scene
