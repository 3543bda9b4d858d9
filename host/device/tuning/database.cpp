#include "device/tuning/database.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/write_file.h"

namespace kdray::tuning {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr const char* kFormat = "kdray_tunings";
constexpr int kVersion = 1;

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw input_error(name, 0, what);
}

Json to_json(const Entry& e) {
  Json settings_json = Json::object();
  for (const Setting& s : settings())
    if (e.settings.*s.value != 0) settings_json[std::string(s.name)] = e.settings.*s.value;
  return {{"device", e.key.device},     {"driver", e.key.driver},     {"kernels", e.key.kernels},
          {"schedule", e.key.schedule}, {"features", e.key.features}, {"settings", settings_json},
          {"ratio", e.ratio},           {"seconds", e.seconds},       {"when", e.when},
          {"scenes", e.scenes}};
}

// Checks the kind of number, since get() would convert another kind without failing.
std::int64_t integer(const Json& json, const std::string& name) {
  if (!json.is_number_integer())
    fail(name,
         fmt::format("{} should be a whole number", json.is_structured() ? json.type_name() : json.dump()));
  return json.get<std::int64_t>();
}

Tuning to_tuning(const Json& json, const std::string& name) {
  Tuning tuning;
  for (const auto& [word, value] : json.items()) {
    const Setting* const s = find_setting(word);
    if (!s) fail(name, fmt::format("no setting is named '{}'", word));
    const std::int64_t number = integer(value, name);
    if (std::ranges::find(s->values, number) == s->values.end())
      fail(name, fmt::format("{} is not a value of '{}'", number, word));
    tuning.*s->value = static_cast<int>(number);
  }
  return tuning;
}

Entry to_entry(const Json& json, const std::string& name) {
  const auto text = [&](const char* word) { return json.at(word).get<std::string>(); };
  return {.key = {text("device"), text("driver"), text("kernels"), text("schedule"), text("features")},
          .settings = to_tuning(json.at("settings"), name),
          .ratio = json.at("ratio").get<double>(),
          .seconds = json.at("seconds").get<double>(),
          .when = integer(json.at("when"), name),
          .scenes = json.at("scenes").get<std::vector<std::string>>()};
}

}  // namespace

std::string features_text(std::uint64_t mask) {
  return fmt::format("{:#018x}", mask);
}

Database Database::parse(const std::string& text, const std::string& name) {
  Database database;
  try {
    const Json json = Json::parse(text);
    if (integer(json.at(kFormat), name) != kVersion) fail(name, "tunings of another version");
    for (const Json& entry : json.at("entries")) database.put(to_entry(entry, name));
  } catch (const Json::exception&) {
    fail(name, "not a file of tunings");
  }
  return database;
}

Database Database::read(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return {};
  if (fs::is_directory(file, error)) fail(file.string(), "is a folder, not a file of tunings");
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(file.string(), "can't be read");
  return parse({std::istreambuf_iterator<char>(in), {}}, file.string());
}

const Entry* Database::find(const Key& key) const {
  Key any = key;
  any.features = kAnyFeatures;
  for (const Key& wanted : {key, any}) {
    const auto found = std::ranges::find(entries_, wanted, &Entry::key);
    if (found != entries_.end()) return &*found;
  }
  return nullptr;
}

void Database::put(const Entry& entry) {
  const auto found = std::ranges::find(entries_, entry.key, &Entry::key);
  if (found == entries_.end())
    entries_.push_back(entry);
  else if (found->when <= entry.when)
    *found = entry;
}

void Database::merge(const Database& other) {
  for (const Entry& entry : other.entries_) put(entry);
}

std::string Database::text() const {
  Json json = {{kFormat, kVersion}, {"entries", Json::array()}};
  for (const Entry& entry : entries_) json["entries"].push_back(to_json(entry));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void Database::write(const fs::path& file) const {
  std::error_code error;  // write_file tells of a folder that is not there
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  write_file(file, text());
}

fs::path default_file() {
  if (const char* const file = std::getenv("KDRAY_TUNE_FILE")) return file;
  if (const char* const data = std::getenv("XDG_DATA_HOME"); data && fs::path(data).is_absolute())
    return fs::path(data) / "kdray" / "tune.json";
  if (const char* const home = std::getenv("HOME"); home && *home)
    return fs::path(home) / ".local" / "share" / "kdray" / "tune.json";
  return {};
}

}  // namespace kdray::tuning
