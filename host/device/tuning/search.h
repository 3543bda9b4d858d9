// What    Looks for the fastest settings within a budget of seconds: coordinate descent with a race at each
//         step.
// Shape   A race compares candidates with a champion, in rounds in which each renders once, until the fastest
//         is clear. A round's times are compared with the champion's of the same round, since a machine's
//         speed drifts; every second round runs backwards. A rival that is clearly slower is dropped at once,
//         and after some rounds more the slower half of those that are left (successive halving), so that
//         time goes to what may win.
//         The next setting is the one of the largest expected gain for its cost. The cost is known from how
//         long frames and compiling took; the expected gain is a guess for a setting that wasn't raced, later
//         a part of what other settings have gained since (if they gained nothing, it isn't raced again). The
//         search ends when no setting's expected gain, over the frames to come, is worth its race, or none
//         fits into what is left of the budget. At the end the winner meets the start in a race of more
//         rounds; unless it is surely faster there, and on no scene slower, the start stays: a search may
//         find nothing, but should never make things worse.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "device/tuning/settings.h"
#include "kdray/options.h"

namespace kdray::tuning {

// How candidates are tried. The first trial of one may compile.
struct Lab {
  // Renders once and compares with the reference. Returns what is wrong, or an empty text.
  std::function<std::string(const Tuning&)> fault;
  // Seconds of a frame of each scene.
  std::function<std::vector<double>(const Tuning&)> measure;
  std::function<double()> now;                           // seconds since the search began
  std::function<void(double)> progress = [](double) {};  // share of the budget
};

enum class Verdict { won, no_better, slower, wrong };
const char* name_of(Verdict verdict);

struct Rival {
  Tuning tuning;
  Verdict verdict = Verdict::no_better;
  std::string fault = {};  // of a wrong one
  // The rival's time over the champion's for each round, as the geometric mean over the scenes.
  std::vector<double> ratios = {};
  std::vector<std::vector<double>> of_scenes = {};  // the same of each scene, by rounds
  std::vector<double> seconds = {};                 // of all scenes' frames together, by rounds

  double ratio() const;                 // the median; 1 without a round
  double worst_scene() const;           // the largest of the scenes' medians
  bool surely_faster(double by) const;  // by that share or more, and in at least three rounds of four
};

struct RaceLimits {
  int rounds = 9;
  double until = 0;  // Lab::now() when it has to end
};

// Fills in the rivals; those with a wrong output are never timed. At most one has won.
void race(const Lab& lab, const Tuning& champion, std::vector<Rival>& rivals, const RaceLimits& limits);

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

// Throws ErrorCode::internal where the output of `start` is wrong.
Found search(const Lab& lab, const Tuning& start, const SearchOptions& options);

}  // namespace kdray::tuning
