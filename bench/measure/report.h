// What    What all reports have in common: the JSON of repeated measurements, of lists and of what may be
//         missing; the words of tables; what a run was measured on.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>

#include "bench/measure/spread.h"
#include "kdray/statistics.h"

namespace kdray::bench {

using Json = nlohmann::ordered_json;

inline Json json_of(const Spread& s) {
  return {{"median", s.median}, {"min", s.min}, {"max", s.max}};
}

// null where there is nothing.
template <class T>
Json json_if(const std::optional<T>& value) {
  if (!value) return Json();
  if constexpr (std::is_same_v<T, Spread>)
    return json_of(*value);
  else
    return Json(*value);
}

template <class Items, class JsonOf>
Json json_list(const Items& items, const JsonOf& json_of_item) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(json_of_item(item));
  return list;
}

// A scene's name in tables and plots: "balls" of ".../balls.nff.gz".
inline std::string short_name(const std::string& name_or_file) {
  const std::string file = std::filesystem::path(name_or_file).filename().string();
  return file.substr(0, file.find('.'));
}

// "1 core", "8 cores"
inline std::string counted(long long n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

template <class Number>
double millions(Number n) {
  return 1e-6 * static_cast<double>(n);
}

// A column of a table; "-" where there is nothing to tell.
std::string cell(const std::optional<double>& value, int width, int digits);

struct Machine {
  int cores = 1;  // kdray's on a CPU, and as many threads for those beside it
  std::string device = {}, vectors = {};
};

// Of a frame: "primary", "shadow", "reflected", "refracted" and "total".
std::map<std::string, std::uint64_t> rays_by_kind(const Statistics& statistics);

// Of what the Renderer runs on that has these statistics. A GPU's compute units say nothing of the cores that
// others may use.
Machine machine_of(const Statistics& statistics);

}  // namespace kdray::bench
