// What    What `kdray tune` found, kept in a small JSON file: the settings for a device with its driver,
//         these kernels, a schedule and a scene's feature mask.
// Shape   { "kdray_tunings": 1, "entries": [ { key, "settings": {...}, what is known of them } ] }. An entry
//         whose features are "any" serves scenes that have none of their own. Of two entries with one key the
//         newer stays.
// Errors  ErrorCode::input for a file that can't be read, isn't of this form, or names a value that isn't in
//         the table of settings: the file may come from anywhere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "device/tuning/settings.h"

namespace kdray::tuning {

inline const std::string kAnyFeatures = "any";

struct Key {
  std::string device, driver;
  std::string kernels;   // a hash of their source
  std::string schedule;  // "slices", "global"
  std::string features;  // the mask, as "0x00010f0000010000"; or kAnyFeatures
  bool operator==(const Key&) const = default;
};

std::string features_text(std::uint64_t mask);

struct Entry {
  Key key;
  Tuning settings;
  double ratio = 1;       // time over that of what kdray ships with, as measured then
  double seconds = 0;     // that the search took
  std::int64_t when = 0;  // seconds since 1970
  std::vector<std::string> scenes;
};

class Database {
 public:
  static Database parse(const std::string& text, const std::string& name);
  static Database read(const std::filesystem::path& file);  // empty where there is no such file

  const std::vector<Entry>& entries() const { return entries_; }

  // Returns the entry for these features, or else the one for any.
  const Entry* find(const Key& key) const;

  void put(const Entry& entry);
  void merge(const Database& other);

  std::string text() const;
  void write(const std::filesystem::path& file) const;  // whole or not at all; makes the folder

 private:
  std::vector<Entry> entries_;
};

// Returns $KDRAY_TUNE_FILE, $XDG_DATA_HOME/kdray/tune.json or ~/.local/share/kdray/tune.json; empty where
// there is no home, or where KDRAY_TUNE_FILE is set to nothing.
std::filesystem::path default_file();

}  // namespace kdray::tuning
