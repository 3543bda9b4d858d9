// What    Looks for the fastest settings within a budget of seconds: coordinate descent, a race (race.h) at
//         each step.
// Shape   The next setting is the one of the largest expected gain for its cost. The cost is known from what
//         frames and compiling took; the expected gain is a guess for a setting that wasn't raced, later a
//         part of what other settings have gained since (what has not changed need not be asked again). It
//         ends when no setting's expected gain, over the frames that are to come, is worth its race, or none
//         fits into what is left of the budget. At last the winner meets the start in a race of more rounds;
//         unless it is surely faster there, and on no scene slower, the start
//         stays: a search may find nothing, but should never make things worse.
#pragma once

#include <string>
#include <vector>

#include "device/tuning/race.h"
#include "device/tuning/settings.h"

namespace kdray::tuning {

struct SearchOptions {
  double budget = 20;     // seconds
  double frames = 10000;  // that the settings will be used for
  bool global = false;    // the schedule
};

// A race of one setting's values.
struct Step {
  const Setting* setting;
  int before = 0, after = 0;  // the champion's value; 0: kdray's own
  double ratio = 1;           // of the time after to before
  double seconds = 0;         // that it took
  std::vector<Rival> rivals;
};

struct Found {
  Tuning best;       // the start where nothing was surely faster
  double ratio = 1;  // its time over the start's, in the last race
  bool kept_start = true;
  std::vector<Step> steps;
  Rival last;  // the last race; without rounds where there was none
  double seconds = 0;
  std::string ended_by;  // in words
};

// `start` must be right; throws ErrorCode::internal where its output isn't.
Found search(const Lab& lab, const Tuning& start, const SearchOptions& options);

}  // namespace kdray::tuning
