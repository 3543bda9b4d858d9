// What    Finds the real scenes that tests read; a test skips, saying so, where they are missing.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace kdray::test {

inline std::filesystem::path data_path(const std::string& name) {
  return std::filesystem::path(KDRAY_DATA_DIR) / name;
}
inline std::filesystem::path source_path(const std::string& name) {
  return std::filesystem::path(KDRAY_SOURCE_DIR) / name;
}

}  // namespace kdray::test

// Ends the test as skipped when the data file is not there.
#define KDRAY_NEED_DATA(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no data: " << (path)
