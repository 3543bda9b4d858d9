// What    Words without regard to capitals, of ASCII alone: keywords, names of materials and files.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace kdray::scene {

constexpr char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

inline std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower(c);
  return out;
}

inline bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace kdray::scene
