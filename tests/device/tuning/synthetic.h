// What    A machine that is only a formula: the time of a frame is known for every setting, its noise is
//         seeded, its clock is what frames and compiling would have taken.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "device/tuning/search.h"
#include "device/tuning/settings.h"

namespace kdray::test {

class Synthetic {
 public:
  // Factors of a frame's time, by setting and value; what isn't named is 1.
  using Factors = std::map<std::string, std::map<int, double>>;

  explicit Synthetic(Factors factors, double noise = 0, unsigned seed = 1)
      : factors_(std::move(factors)), noise_(noise), random_(seed) {}

  double exact(const Tuning& t) const {
    double seconds = frame;
    for (const auto& [name, values] : factors_) {
      const auto found = values.find(t.*tuning::find_setting(name)->value);
      if (found != values.end()) seconds *= found->second;
    }
    return seconds;
  }

  tuning::Lab lab() {
    tuning::Lab lab;
    lab.fault = [this](const Tuning& t) {
      if (compiles(t)) now += compile;
      now += exact(t);
      return wrong && wrong(t) ? std::string("pixel 3, 4 differs") : std::string();
    };
    lab.measure = [this](const Tuning& t) {
      ++frames;
      if (wrong && wrong(t)) timed_wrong = true;
      // A drift that is slow beside a round, and noise of each frame of its own.
      const double seconds = exact(t) * (1 + 0.3 * std::sin(0.2 * now)) * std::exp(noise_ * normal_(random_));
      now += seconds;
      return std::vector<double>{seconds};
    };
    lab.now = [this] { return now; };
    return lab;
  }

  double frame = 0.02, compile = 0.5;  // seconds
  double now = 0;
  int frames = 0;
  std::function<bool(const Tuning&)> wrong;
  bool timed_wrong = false;

 private:
  bool compiles(const Tuning& t) {
    std::string constants;
    for (const tuning::Setting& s : tuning::settings())
      if (s.compiles()) constants += std::to_string(t.*s.value) + " ";
    return built_.insert(constants).second;
  }

  Factors factors_;
  double noise_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::set<std::string> built_;
};

}  // namespace kdray::test
