// What    That a report has all the keys that its page promises, and its plot, where python3 can draw one.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "support/folder.h"

namespace kdray::test {

inline void expect_keys(const nlohmann::json& json, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_TRUE(json.contains(key)) << key << " is not in " << json.dump();
}

// Whether the run has said that this machine can't draw.
inline bool has_no_plots(const Outcome& run) {
  return run.err.find("no plot: python3 has no matplotlib") != std::string::npos ||
         run.err.find("no plot: there is no python3") != std::string::npos;
}

inline void expect_plot(const Outcome& run, const Folder& folder, const std::string& file,
                        const std::string& text) {
  if (has_no_plots(run)) return;
  EXPECT_NE(folder.get(file).find(text), std::string::npos) << file << " without " << text << "; " << run.err;
}

}  // namespace kdray::test
