#include "bench/ranks/real.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "api/hooks.h"
#include "api/statistics_json.h"
#include "base/median.h"
#include "base/timer.h"
#include "bench/ranks/record_costs.h"
#include "kdray/error.h"
#include "transport/ranks.h"
#include "wavefront/curve.h"

namespace kdray::bench {

namespace {

// What pdprt gives ranks of one core each (api/scheduler.cpp); one rank alone would have others.
constexpr Tuning kOfRanks{.slices = 1, .waves = 128};
constexpr double kRaysOfBatch = 512;
constexpr int kQueuesByMail = 5;  // so many that ODPRT sorts all rays on the host (odprt/plan.cpp)

// OpenCL is opened by one thread at a time.
Renderer open(const PreparedScene& scene, const RanksAsked& asked, std::shared_ptr<transport::Ranks> ranks,
              int queues = 1) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  api::Hooks hooks;
  hooks.ranks = std::move(ranks);
  Renderer renderer =
      api::make_renderer(scene, {.device = asked.device, .queues = queues, .compute_units = 1}, hooks);
  renderer.tune(kOfRanks);
  return renderer;
}

RenderOptions frame_of(const RanksAsked& asked) {
  RenderOptions o;
  o.width = asked.width, o.height = asked.height, o.depth = asked.depth, o.samples = asked.samples;
  o.tile_width = o.tile_height = asked.tile;
  o.mode = Mode::pdprt;
  return o;
}

// A ray for a ray is simulated in ODPRT: of a smaller frame, and of one sample.
RenderOptions odprt_frame_of(const RanksAsked& asked) {
  RenderOptions o = frame_of(asked);
  o.width = std::max(1, asked.width / 2), o.height = std::max(1, asked.height / 2), o.samples = 1;
  o.mode = Mode::odprt;
  return o;
}

// Does `work` in a thread of its own, and looks at the team's messages meanwhile as a rank does. Returns the
// mean time between two looks.
double look_during(Team& team, const std::function<void()>& work) {
  std::atomic<bool> is_done{false};
  std::jthread thread([&] {
    work();
    is_done = true;
  });
  const Timer timer;
  double n = 0;
  for (; !is_done; ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    team.look();
  }
  return timer.seconds() / std::max(n, 1.0);
}

// One rank of a group, or nobody.
class Place {
 public:
  Place(Team& team, const PreparedScene& scene, const RanksAsked& asked, int n, double delay)
      : real_{.ranks = n, .delay = delay} {
    auto transport = team.group(n, delay);
    if (!transport) return;
    ranks_ = std::make_shared<transport::Ranks>(std::move(transport));
    renderer_.emplace(open(scene, asked, ranks_));
  }

  void render(const RenderOptions& options, bool counts, const Picture& reference) {
    if (!renderer_) return;
    const transport::Counters before = ranks_->counters();
    const Picture picture = renderer_->render(options);
    const transport::Counters& after = ranks_->counters();
    if (!ranks_->leads()) return;
    if (picture.rgb != reference.rgb) ++real_.differing_pixels;
    if (!counts) return;
    real_.rounds.push_back(renderer_->statistics().seconds.render);
    double busy = 0;
    const nlohmann::json facts = api::statistics_json(renderer_->statistics());
    for (const auto& queue : facts.at("mode").at("per_queue")) busy += queue.at("busy_seconds").get<double>();
    busy_.push_back(busy);
    const auto sent = facts.find("mode")->find("exchange");
    rays_.push_back(sent == facts.at("mode").end() ? 0 : sent->at("rays_total").get<double>());
    messages_.push_back(static_cast<double>(after.sent + after.received - before.sent - before.received));
    bytes_.push_back(static_cast<double>(after.bytes_sent + after.bytes_received - before.bytes_sent -
                                         before.bytes_received));
  }

  RealRanks real() const {
    RealRanks real = real_;
    if (!messages_.empty())
      real.messages = median(messages_), real.bytes = median(bytes_), real.busy = median(busy_),
      real.rays_sent = median(rays_);
    return real;
  }

 private:
  RealRanks real_;
  std::shared_ptr<transport::Ranks> ranks_;
  std::optional<Renderer> renderer_;
  std::vector<double> messages_, bytes_, busy_, rays_;
};

class Measuring {
 public:
  Measuring(Team& team, const PreparedScene& scene, const RanksAsked& asked)
      : team_(team),
        asked_(asked),
        options_(frame_of(asked)),
        odprt_options_(odprt_frame_of(asked)),
        alone_(open(scene, asked, nullptr)) {
    for (const int n : asked.ranks)
      for (const double delay : asked.delays)
        if (n <= team.size() && (n > 1 || delay == 0)) {
          places_.emplace_back(team, scene, asked, n, delay);
          if (asked.odprt) odprt_places_.emplace_back(team, scene, asked, n, delay);
        }
    if (!asked.odprt || !team.leads()) return;
    odprt_alone_.emplace(open(scene, asked, nullptr));
    odprt_by_mail_.emplace(open(scene, asked, nullptr, kQueuesByMail));
  }

  RanksMeasured run() {
    measured_.messages = ping_pong(team_);
    for (int round = -1; round < asked_.repeat; ++round) {
      if (round <= 0) clear();
      measure_alone();
      for (const int n : asked_.ranks)
        if (n <= team_.size()) measure_at_once(n);
      for (Place& place : places_) {
        team_.meet();
        place.render(options_, round >= 0, picture_);
      }
      measure_odprt_alone();
      for (Place& place : odprt_places_) {
        team_.meet();
        place.render(odprt_options_, round >= 0, odprt_picture_);
      }
      team_.meet();
    }
    if (team_.leads()) conclude();
    if (odprt_alone_) conclude_odprt();
    return std::move(measured_);
  }

 private:
  void clear() {
    alone_seconds_.clear(), busy_.clear(), tiles_.clear(), prepare_.clear(), begin_.clear(), end_.clear();
    waves_.clear(), at_once_.clear(), looks_.clear();
    odprt_seconds_.clear(), odprt_busy_.clear(), odprt_trace_.clear(), odprt_of_sent_.clear();
  }

  // A frame that keeps its tiles' times.
  void measure_alone() {
    team_.meet();
    if (!team_.leads()) return;
    RenderOptions options = options_;
    options.timeline = true;
    picture_ = alone_.render(options);
    const nlohmann::json facts = api::statistics_json(alone_.statistics());
    measured_.device = facts.at("device").at("name");
    const double seconds = facts.at("seconds").at("render"), prepare = facts.at("seconds").at("prepare");
    alone_seconds_.push_back(seconds);
    busy_.push_back(facts.at("mode").at("per_queue").at(0).at("busy_seconds"));
    if (!facts.at("mode").contains("tile_seconds"))
      throw Error(ErrorCode::no_device, "the device doesn't tell what tiles cost");
    tiles_.push_back(facts.at("mode").at("tile_seconds").get<std::vector<double>>());
    waves_.push_back(facts.at("mode").at("waves"));
    prepare_.push_back(prepare);
    const auto [first, last] = launches_of(alone_.timeline());
    begin_.push_back(std::max(0.0, first - prepare));
    end_.push_back(std::max(0.0, seconds - (last - first) - begin_.back()));
  }

  // One queue, which sends nothing; then several on the same core, whose rays all go through the host.
  void measure_odprt_alone() {
    team_.meet();
    if (!odprt_alone_) return;
    odprt_picture_ = odprt_alone_->render(odprt_options_);
    const nlohmann::json facts = api::statistics_json(odprt_alone_->statistics());
    const nlohmann::json& seconds = facts.at("seconds");
    odprt_seconds_.push_back(seconds.at("render"));
    odprt_busy_.push_back(facts.at("mode").at("per_queue").at(0).at("busy_seconds"));
    const double trace = seconds.value("trace", 0.0);
    double all = trace;
    for (const char* const stage : {"shade", "admit", "add", "route"}) all += seconds.value(stage, 0.0);
    odprt_trace_.push_back(all > 0 ? trace / all : 1);
    constexpr const char* kKinds[] = {"primary", "shadow", "reflected", "refracted"};  // by LifeKind
    for (std::size_t kind = 0; kind < std::size(kKinds); ++kind)
      measured_.odprt.rays[kind] = facts.at("rays").value(kKinds[kind], 0.0);
    odprt_by_mail_->render(odprt_options_);
    const nlohmann::json by_mail = api::statistics_json(odprt_by_mail_->statistics());
    const double sent = by_mail.at("mode").at("exchange").at("rays_total");
    const double more = by_mail.at("seconds").at("render").get<double>() - odprt_seconds_.back();
    odprt_of_sent_.push_back(std::max(0.0, more) / std::max(sent, 1.0));
  }

  static std::pair<double, double> launches_of(const std::string& chrome_trace) {
    double first = 1e9, last = 0;
    const nlohmann::json trace = nlohmann::json::parse(chrome_trace);
    for (const auto& event : trace.at("traceEvents")) {
      if (event.at("ph") != "X") continue;
      const double start = 1e-6 * event.at("ts").get<double>();
      first = std::min(first, start);
      last = std::max(last, start + 1e-6 * event.at("dur").get<double>());
    }
    return {first, last};
  }

  void measure_at_once(int n) {
    team_.meet();
    double seconds = 0, look = 0;
    if (team_.number() < n) {
      look = look_during(team_, [&] { alone_.render(options_); });
      seconds = alone_.statistics().seconds.render;
    }
    const auto mean_of_first = [n](const std::vector<double>& of_members) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += of_members[static_cast<std::size_t>(i)];
      return sum / n;
    };
    const std::vector<double> all = team_.gather(seconds), looks = team_.gather(look);
    if (!team_.leads()) return;
    at_once_[n].push_back(mean_of_first(all));
    looks_[n].push_back(mean_of_first(looks));
  }

  void conclude() {
    measured_.alone = spread_of(alone_seconds_);
    measured_.busy = median(busy_);
    for (const Place& place : places_) measured_.real.push_back(place.real());
    for (int round = 0; round < asked_.repeat; ++round) conclude(static_cast<std::size_t>(round));
    for (const auto& [n, looks] : looks_) {
      std::vector<double> speeds;
      for (const RanksRound& round : measured_.rounds) speeds.push_back(round.at_once.at(n).speed);
      measured_.at_once[n] = {median(speeds), median(looks)};
    }
    ReplayedFrame& frame = measured_.frame;
    frame.width = static_cast<std::uint32_t>(asked_.width),
    frame.height = static_cast<std::uint32_t>(asked_.height);
    frame.tile_width = frame.tile_height = static_cast<std::uint32_t>(asked_.tile);
    const auto n_tiles = [&](std::uint32_t pixels) {
      return (pixels + frame.tile_width - 1) / frame.tile_width;
    };
    frame.curve = wavefront::tile_curve(n_tiles(frame.width), 0, n_tiles(frame.height));
    frame.tile_seconds = least_of_tiles();
    frame.wave_seconds = measured_.busy / std::max(1.0, median(waves_));
    frame.waves_of_launch = kOfRanks.waves;
    frame.guessed_waves = 2.0 * asked_.tile * asked_.tile * asked_.samples / kRaysOfBatch;
    frame.prepare_seconds = median(prepare_);
    const RecordCosts records = record_costs(asked_.tile, asked_.tile);
    frame.deliver_seconds = records.deliver, frame.take_back_seconds = records.take_back;
    frame.begin_seconds = median(begin_), frame.end_seconds = end_of_frame();
    frame.index();
  }

  void conclude_odprt() {
    measured_.odprt_width = odprt_options_.width, measured_.odprt_height = odprt_options_.height;
    measured_.odprt_alone = spread_of(odprt_seconds_);
    for (const Place& place : odprt_places_) measured_.real_odprt.push_back(place.real());
    OdprtCosts& costs = measured_.odprt;
    costs.busy = median(odprt_busy_), costs.trace_share = median(odprt_trace_);
    costs.of_sent_ray = *std::ranges::min_element(odprt_of_sent_);  // what disturbs it only adds
    costs.end_seconds = std::max(0.0, measured_.odprt_alone.median - costs.busy);
    for (const RealRanks& real : measured_.real_odprt)
      if (real.ranks == 1) costs.end_seconds = std::max(0.0, median(real.rounds) - real.busy);
  }

  void conclude(std::size_t number) {
    RanksRound& round = measured_.rounds.emplace_back();
    round.alone = at_once_.count(1) ? at_once_[1][number] : alone_seconds_[number];
    for (const auto& [n, seconds] : at_once_)
      round.at_once[n] = {std::min(1.0, round.alone / seconds[number]), looks_[n][number]};
  }

  // What one rank alone takes beside its tiles: all that rank 0 does at the end of a frame.
  double end_of_frame() const {
    const RanksMeasured& m = measured_;
    for (const RealRanks& real : m.real)
      if (real.ranks == 1)
        return std::max(0.0, median(real.rounds) - real.busy - m.frame.begin_seconds -
                                 m.frame.take_back_seconds * static_cast<double>(m.frame.curve.size()));
    return median(end_);
  }

  // Each tile's least over the rounds: somebody else who takes the core in the middle of one only adds, and
  // a slice of time is a hundred tiles long. Together they take as long as the queue was busy.
  std::vector<double> least_of_tiles() const {
    std::vector<double> least = tiles_.front();
    for (const std::vector<double>& round : tiles_)
      for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], round[i]);
    const double scale = measured_.busy / sum(least);
    for (double& seconds : least) seconds *= scale;
    return least;
  }

  Team& team_;
  const RanksAsked& asked_;
  RenderOptions options_;
  RenderOptions odprt_options_;
  Renderer alone_;
  std::optional<Renderer> odprt_alone_, odprt_by_mail_;
  std::vector<Place> places_, odprt_places_;
  Picture picture_, odprt_picture_;
  RanksMeasured measured_;
  std::vector<double> alone_seconds_, busy_, prepare_, begin_, end_, waves_;
  std::vector<double> odprt_seconds_, odprt_busy_, odprt_trace_, odprt_of_sent_;
  std::vector<std::vector<double>> tiles_;
  std::map<int, std::vector<double>> at_once_, looks_;
};

}  // namespace

RanksMeasured measure_ranks(Team& team, const PreparedScene& scene, const RanksAsked& asked) {
  return Measuring(team, scene, asked).run();
}

}  // namespace kdray::bench
