// What    Candidates against a champion: rounds in which each renders once, until it is clear who is fastest.
// Shape   A round's times are held against the champion's of the same round, since a machine's speed drifts;
//         every second round runs backwards. A rival that is clearly slower is dropped at once, and of those
//         that are left the slower half after some rounds more (successive halving), so that time goes to
//         what may win.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kdray/options.h"

namespace kdray::tuning {

// How candidates are looked at. The first look at one may compile.
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

}  // namespace kdray::tuning
