// What    The seed of a random test: the same each time, unless KDRAY_TEST_SEED names another, so that a fuzz
//         of minutes is a loop over seeds.
#pragma once

#include <cstdlib>

namespace kdray::test {

inline unsigned seed_or(unsigned usual) {
  const char* const asked = std::getenv("KDRAY_TEST_SEED");
  return asked ? static_cast<unsigned>(std::strtoul(asked, nullptr, 10)) : usual;
}

}  // namespace kdray::test
