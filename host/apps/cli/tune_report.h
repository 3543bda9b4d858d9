// What    What a search found, and how it holds up against what kdray ships with: for people, and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "device/tuning/search.h"

namespace kdray::cli {

struct Tuned {
  std::vector<std::string> scenes;
  tuning::Found found;
};

// A scene rendered with the entry that render would take, against none.
struct Checked {
  std::string scene;
  Tuning settings;
  tuning::Rival rival;
};

std::string one_line_of(const Tuned& tuned);
std::string explain(const tuning::Found& found);  // what each setting bought, and what else was tried
std::string table_of(const std::vector<Checked>& checked);

nlohmann::json json_of(const std::vector<Tuned>& tuned, const std::vector<Checked>& checked);

}  // namespace kdray::cli
