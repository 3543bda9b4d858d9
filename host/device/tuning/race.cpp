#include "device/tuning/race.h"

#include <algorithm>
#include <cmath>

#include "base/median.h"

namespace kdray::tuning {

namespace {

constexpr double kClearlySlower = 1.02;                           // in each of the first rounds
constexpr std::size_t kFirstLook = 2, kHalving = 3, kFewest = 5;  // rounds
constexpr double kLeastGain = 0.01;                               // what is less isn't told from noise

bool running(const Rival& r) {
  return r.fault.empty() && r.verdict == Verdict::no_better;
}

std::vector<double> over(const std::vector<double>& times, const std::vector<double>& champion) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < times.size(); ++i) ratios.push_back(times[i] / champion[i]);
  return ratios;
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += std::log(v);
  return std::exp(sum / static_cast<double>(values.size()));
}

// The champion goes first, or in a round that runs backwards last.
void run_round(const Lab& lab, const Tuning& champion, std::vector<Rival*> rivals, bool backwards) {
  std::vector<std::vector<double>> times;
  std::vector<double> own;
  if (backwards) std::ranges::reverse(rivals);
  if (!backwards) own = lab.measure(champion);
  for (const Rival* r : rivals) times.push_back(lab.measure(r->tuning));
  if (backwards) own = lab.measure(champion);
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    rivals[i]->of_scenes.push_back(over(times[i], own));
    rivals[i]->ratios.push_back(geometric_mean(rivals[i]->of_scenes.back()));
  }
}

void drop_slow(std::vector<Rival*>& left, std::size_t rounds) {
  const auto is_slow = [&](const Rival* r) {
    if (rounds == kFirstLook) return std::ranges::min(r->ratios) > kClearlySlower;
    return rounds >= kHalving && r->ratio() > 1;
  };
  for (Rival* r : left)
    if (is_slow(r)) r->verdict = Verdict::slower;
  std::erase_if(left, [](const Rival* r) { return !running(*r); });
}

void halve(std::vector<Rival*>& left) {
  std::ranges::sort(left, {}, &Rival::ratio);
  left.resize((left.size() + 1) / 2);
}

std::vector<Rival*> checked(const Lab& lab, std::vector<Rival>& rivals) {
  std::vector<Rival*> left;
  for (Rival& r : rivals) {
    r.fault = lab.fault(r.tuning);
    if (r.fault.empty())
      left.push_back(&r);
    else
      r.verdict = Verdict::wrong;
  }
  return left;
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::won:
      return "won";
    case Verdict::slower:
      return "slower";
    case Verdict::wrong:
      return "wrong";
    default:
      return "no better";
  }
}

double Rival::ratio() const {
  return ratios.empty() ? 1 : median(ratios);
}

double Rival::worst_scene() const {
  double worst = 0;
  for (std::size_t scene = 0; !of_scenes.empty() && scene < of_scenes.front().size(); ++scene) {
    std::vector<double> own;
    for (const std::vector<double>& round : of_scenes) own.push_back(round[scene]);
    worst = std::max(worst, median(own));
  }
  return worst > 0 ? worst : 1;
}

bool Rival::surely_faster(double by) const {
  const auto faster = static_cast<std::size_t>(std::ranges::count_if(ratios, [](double r) { return r < 1; }));
  return ratio() < 1 - by && 4 * faster >= 3 * ratios.size();
}

void race(const Lab& lab, const Tuning& champion, std::vector<Rival>& rivals, const RaceLimits& limits) {
  std::vector<Rival*> left = checked(lab, rivals);
  std::size_t rounds = 0;
  const auto most = static_cast<std::size_t>(limits.rounds);
  while (!left.empty() && rounds < most && lab.now() < limits.until) {
    run_round(lab, champion, left, rounds % 2 == 1);
    ++rounds;
    drop_slow(left, rounds);
    if (rounds == kHalving || rounds == kFewest) halve(left);
  }
  if (left.empty() || rounds < std::min(kFewest, most)) return;
  Rival& best = **std::ranges::min_element(left, {}, &Rival::ratio);
  if (best.surely_faster(kLeastGain)) best.verdict = Verdict::won;
}

}  // namespace kdray::tuning
