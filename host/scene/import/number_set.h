// What    A set of numbers below n, and the next member from a number on, cyclically: in a few steps, however
//         few members are left.
// Shape   Bits in words of 64, and above them words whose bits say which words below are not 0, up to one
//         word.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace kdray::scene {

class NumberSet {
 public:
  explicit NumberSet(std::size_t n) {
    do {
      n = (n + 63) / 64;
      levels_.emplace_back(n, 0);
    } while (n > 1);
  }

  void add(std::size_t i) {
    for (auto& words : levels_) {
      words[i / 64] |= std::uint64_t{1} << (i % 64);
      i /= 64;
    }
  }

  void remove(std::size_t i) {
    for (auto& words : levels_) {
      if (words[i / 64] &= ~(std::uint64_t{1} << (i % 64))) return;
      i /= 64;
    }
  }

  // The first member that is not below i; if there is none, the first of all.
  std::optional<std::uint32_t> next(std::size_t i) const {
    if (const auto found = next_from(i)) return found;
    return next_from(0);
  }

 private:
  std::optional<std::uint32_t> next_from(std::size_t i) const {
    std::size_t level = 0;
    for (; level < levels_.size(); ++level, i = i / 64 + 1) {  // behind the word that had none
      if (i / 64 >= levels_[level].size()) return std::nullopt;
      const std::uint64_t rest = levels_[level][i / 64] >> (i % 64);
      if (rest == 0) continue;
      i += static_cast<std::size_t>(std::countr_zero(rest));
      break;
    }
    if (level == levels_.size()) return std::nullopt;
    while (level > 0) {
      --level;
      i = 64 * i + static_cast<std::size_t>(std::countr_zero(levels_[level][i]));
    }
    return static_cast<std::uint32_t>(i);
  }

  std::vector<std::vector<std::uint64_t>> levels_;
};

}  // namespace kdray::scene
