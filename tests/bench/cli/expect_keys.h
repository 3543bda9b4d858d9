// What    That a report has all the keys that its page promises.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kdray::test {

inline void expect_keys(const nlohmann::json& json, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_TRUE(json.contains(key)) << key << " is not in " << json.dump();
}

}  // namespace kdray::test
