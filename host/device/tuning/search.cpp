#include "device/tuning/search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/timer.h"
#include "kdray/error.h"

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
    rivals[i]->seconds.push_back(std::accumulate(times[i].begin(), times[i].end(), 0.0));
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

namespace {

constexpr double kGuess = 0.02;  // what a setting gains that nobody has looked at
constexpr double kEcho = 0.25;   // of what others gained since, that a setting may gain anew
constexpr double kWorthwhile = 0.003;
// What a program takes at least, in seconds, until one was compiled here (the start's may come from a cache).
constexpr double kCompile = 1.5;
constexpr int kRounds = 9, kLastRounds = 15, kUsualLastRounds = 9, kLeastRounds = 5;
constexpr double kLastShare = 0.25;  // of the budget, that the last race may take
constexpr double kUsualRounds = 3;   // before most rivals are dropped
constexpr double kSlack = 1.01;      // that a scene may seem slower, by noise

class Search {
 public:
  Search(const Lab& lab, const Tuning& start, const SearchOptions& options)
      : lab_(lab), options_(options), start_(start) {
    found_.best = start;
  }

  Found run() {
    look_at_start();
    while (const Setting* next = choose()) {
      found_.steps.push_back(step(*next));
      lab_.progress(lab_.now() / options_.budget);
    }
    confirm();
    found_.seconds = lab_.now();
    return std::move(found_);
  }

 private:
  // The first frame compiles, the second tells how long one takes.
  void look_at_start() {
    const double begun = lab_.now();
    if (const std::string fault = lab_.fault(start_); !fault.empty())
      throw Error(ErrorCode::internal, "kdray's own settings give a wrong picture: " + fault);
    const double first = lab_.now() - begun;
    const std::vector<double> times = lab_.measure(start_);
    frame_ = std::reduce(times.begin(), times.end());
    round_ = std::max(lab_.now() - begun - first, 1e-9);
    compile_ = std::max(kCompile, first - round_);
  }

  bool applies(const Setting& s) const { return options_.global ? s.global : s.slices; }

  std::vector<Rival> rivals_of(const Setting& s) const {
    std::vector<Rival> rivals;
    std::vector<int> values = s.values;
    values.push_back(start_.*s.value);
    for (const int value : values) {
      if (value == found_.best.*s.value) continue;
      Rival rival{found_.best};
      rival.tuning.*s.value = value;
      rivals.push_back(std::move(rival));
    }
    return rivals;
  }

  double cost_of(const Setting& s) const {
    const auto n = static_cast<double>(rivals_of(s).size());
    return n * ((s.compiles() ? compile_ : 0) + round_) + kUsualRounds * (n + 1) * round_;
  }

  double expected_gain(const Setting& s) const {
    const auto at = raced_at_.find(&s);
    return at == raced_at_.end() ? kGuess : kEcho * (gained_ - at->second);
  }

  double reserve() const { return std::min(kLastShare * options_.budget, 2 * kUsualLastRounds * round_); }

  // Chooses the next setting; where there is none, says why.
  const Setting* choose() {
    const Setting* best = nullptr;
    double best_worth = 0;
    bool too_dear = false, no_time = false;
    for (const Setting& s : settings()) {
      const double gain = expected_gain(s), cost = cost_of(s);
      if (!applies(s) || gain < kWorthwhile) continue;
      if (gain * frame_ * options_.frames < cost) {
        too_dear = true;
      } else if (lab_.now() + cost + reserve() > options_.budget) {
        no_time = true;
      } else if (gain / cost > best_worth) {
        best_worth = gain / cost;
        best = &s;
      }
    }
    found_.ended_by = no_time    ? "the budget is spent"
                      : too_dear ? "what is left would take longer than it is expected to save"
                                 : "nothing more to gain is expected";
    return best;
  }

  Step step(const Setting& s) {
    const double begun = lab_.now();
    Step done{
        .setting = &s, .before = found_.best.*s.value, .after = found_.best.*s.value, .rivals = rivals_of(s)};
    double first_looks = 0;
    Lab timed = lab_;
    timed.fault = [&](const Tuning& tuning) {
      const double from = lab_.now();
      std::string fault = lab_.fault(tuning);
      first_looks += lab_.now() - from;
      return fault;
    };
    race(timed, found_.best, done.rivals, {kRounds, options_.budget - reserve()});
    if (s.compiles())
      compile_ = std::max(0.0, first_looks / static_cast<double>(done.rivals.size()) - round_);
    for (const Rival& r : done.rivals) {
      if (r.verdict != Verdict::won) continue;
      done.after = r.tuning.*s.value;
      done.ratio = r.ratio();
      found_.best = r.tuning;
      gained_ += 1 - done.ratio;
    }
    raced_at_[&s] = gained_;
    done.seconds = lab_.now() - begun;
    return done;
  }

  // The budget has a reserve for this race; a round or two may go beyond it.
  void confirm() {
    if (found_.best == start_) return;
    std::vector<Rival> last = {{found_.best}};
    const int fit = static_cast<int>((options_.budget - lab_.now()) / (2 * round_));
    race(lab_, start_, last, {std::clamp(fit, kLeastRounds, kLastRounds), 1e30});
    found_.last = last.front();
    found_.kept_start = last.front().verdict != Verdict::won || last.front().worst_scene() > kSlack;
    if (found_.kept_start)
      found_.best = start_;
    else
      found_.ratio = last.front().ratio();
  }

  const Lab& lab_;
  SearchOptions options_;
  Tuning start_;
  Found found_;
  double frame_ = 0, round_ = 0,
         compile_ = 0;  // seconds: of the frames alone; of all it takes to measure; to compile
  double gained_ = 0;
  std::map<const Setting*, double> raced_at_;  // gained_ when that was done
};

}  // namespace

Found search(const Lab& lab, const Tuning& start, const SearchOptions& options) {
  return Search(lab, start, options).run();
}

}  // namespace kdray::tuning
