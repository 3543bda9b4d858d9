#include "device/tuning/search.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "kdray/error.h"

namespace kdray::tuning {

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

  // The budget was left some room for it; a round or two may go beyond.
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
