// What    The settings that may be tuned, in one table, and what kdray ships with for each kind of device.
// Shape   Each is a whole number in Tuning (kdray/options.h). 0 leaves it to kdray's own choice, which rules
//         make (api/scheduler.cpp, wavefront/programs.cpp) or constants of the kernels.
// Why     Nothing in the table changes a bit of a picture: `kdray tune` may try anything, and a file of
//         foreign settings can only cost time.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kdray/options.h"

namespace kdray::tuning {

struct Setting {
  std::string_view name;
  int Tuning::*value;
  std::vector<int> values;    // worth a try beside kdray's own choice
  std::string_view programs;  // that it compiles anew; empty: none
  bool slices, global;        // schedules that look at it
  std::string_view what;

  bool compiles() const { return !programs.empty(); }
};

// They come in the order in which they are worth trying: first what costs no compiling.
std::span<const Setting> settings();

const Setting* find_setting(std::string_view name);

// Returns what kdray ships with for a kind of device (DeviceInfo::kind).
Tuning shipped(std::string_view kind);

// Returns the settings of `over`, and those of `under` where `over` has 0.
Tuning merged(const Tuning& under, const Tuning& over);

// Returns, for example, "batch 1024, packets 16": what is left to kdray isn't named; where everything is,
// "kdray's own".
std::string in_words(const Tuning& tuning);

}  // namespace kdray::tuning
