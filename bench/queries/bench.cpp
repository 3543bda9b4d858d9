#include "bench/queries/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "bench/embree/embree.h"
#include "bench/measure/stopwatch.h"
#include "bench/race/compare.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

namespace {

constexpr int kWarmUps = 2;

// Calls in a round: few of large batches, and of small ones enough for the clock.
std::size_t calls_of(std::size_t batch, std::size_t n) {
  constexpr std::size_t kMostCalls = 1000, kMostRays = 100'000;
  return std::clamp<std::size_t>(kMostRays / batch, 1,
                                 std::min(kMostCalls, std::max<std::size_t>(n / batch, 1)));
}

QueriesOptions resolved(QueriesOptions o) {
  if (o.sets.empty()) o.sets.assign(set_names().begin(), set_names().end());
  if (o.questions.empty()) o.questions.assign(question_names().begin(), question_names().end());
  for (int& batch : o.batches) batch = std::min(batch, o.rays);
  o.batches.erase(std::unique(o.batches.begin(), o.batches.end()), o.batches.end());
  return o;
}

// One side of a cell, as it runs.
struct Runner {
  const Side* side;
  const Side::Form* form;
  std::vector<double> wall = {}, cpu = {};
  std::size_t n_differing = 0;

  SideResult result() const { return {side->name, form->name, spread_of(wall), spread_of(cpu), n_differing}; }
};

// A question about a set in batches of one size, put to all sides.
class Cell {
 public:
  Cell(Question question, const QuerySet& set, std::size_t batch, double width)
      : question_(question), set_(&set), batch_(batch), calls_(calls_of(batch, set.size())), width_(width) {}

  std::size_t calls() const { return calls_; }

  std::vector<Runner> warm_up(std::span<const Side> sides, int runs) const {
    std::vector<Runner> runners;
    const Side::Form& first = sides.front().forms.front();
    for (const Side& side : sides) {
      Runner runner{&side, nullptr};
      double least = 0;
      // Forms differ in how rays are handed over: points have one.
      const bool has_one = question_ == Question::points;
      for (const Side::Form& form : std::span(side.forms).first(has_one ? 1 : side.forms.size()))
        for (int i = 0; i < runs; ++i) {
          const double seconds = timed(*form.asker).first;
          if (runner.form != nullptr && seconds >= least) continue;
          runner.form = &form;
          least = seconds;
        }
      if (runner.form != &first) runner.n_differing = differing(*first.asker, *runner.form->asker);
      runners.push_back(runner);
    }
    return runners;
  }

  void round(std::vector<Runner>& runners) const {
    for (Runner& runner : runners) {
      const auto [wall, cpu] = timed(*runner.form->asker);
      runner.wall.push_back(wall);
      runner.cpu.push_back(cpu);
    }
  }

 private:
  // Wall and processor seconds of a call, on average.
  std::pair<double, double> timed(Asker& asker) const {
    Answers answers(question_, set_->size());
    const Stopwatch clock;
    for (std::size_t call = 0; call < calls_; ++call)
      asker.ask(question_, *set_, first_of(call), batch_, answers);
    const double wall = clock.wall(), cpu = clock.cpu(), calls = static_cast<double>(calls_);
    return {wall / calls, cpu / calls};
  }

  std::size_t differing(Asker& one, Asker& other) const {
    Answers a(question_, set_->size()), b(question_, set_->size());
    std::size_t n = 0;
    for (std::size_t call = 0; call < calls_; ++call) {
      const std::size_t first = first_of(call);
      one.ask(question_, *set_, first, batch_, a);
      other.ask(question_, *set_, first, batch_, b);
      n += count_differing(question_, a, b, first, batch_, width_);
    }
    return n;
  }

  // Batches are spread over the set.
  std::size_t first_of(std::size_t call) const { return call * (set_->size() / calls_); }

  Question question_;
  const QuerySet* set_;
  std::size_t batch_, calls_;
  double width_;
};

// kdray's walk with rays on the device already, which answers from arrays are to come near to.
class OnDevice {
 public:
  OnDevice(const Scene& scene, const DeviceOptions& device) : renderer_(scene.prepared(), device) {}

  const Statistics& statistics() const { return renderer_.statistics(); }
  double seconds(const std::vector<Ray>& rays, bool any_hit) {
    (void)renderer_.trace(rays, any_hit, 1, Traversal::automatic);
    return renderer_.statistics().seconds.trace;
  }

 private:
  Renderer renderer_;
};

class QueriesScene {
 public:
  QueriesScene(const QueriesOptions& options, const std::string& name, const Working& working)
      : options_(options), name_(name), working_(working) {
    const scene::Scene loaded = load_scene(name);
    mesh_ = mesh_of(loaded, name);
    width_ = glm::length(loaded.bounds().extent());
    device_.device = options.device;
    say("making rays");
    const Stopwatch clock;
    scene_ = std::make_shared<const Scene>(kdray_scene(mesh_, device_));
    run_.first_in_process = clock.wall();
    on_device_.emplace(*scene_, device_);
    sets_ = make_sets(loaded, options.sets, static_cast<std::size_t>(options.rays),
                      [&](std::span<const Ray> rays) { return hits_of(rays); });
  }

  QueriesRun run() {
    run_.scene = name_;
    run_.n_triangles = mesh_.n_triangles();
    run_.machine = machine_of(on_device_->statistics());
    sides_ = {kdray_side(scene_, mesh_, device_)};
    if (options_.geometry == VertexPrecision::float64) sides_.push_back(double_side(mesh_, device_));
    n_own_ = sides_.size();
    if (options_.embree)
      for (Side& side : embree_sides(mesh_, run_.machine.cores)) sides_.push_back(std::move(side));
    if (!sets_.empty()) run_.first_answers = first_answers();
    for (const std::string& question : options_.questions)
      for (const QuerySet& set : sets_)
        for (const int batch : options_.batches)
          run_.cells.push_back(cell(question, set, static_cast<std::size_t>(batch)));
    return std::move(run_);
  }

 private:
  void say(const std::string& what) const { working_(fmt::format("{}: {}", name_, what)); }

  std::vector<Hit> hits_of(std::span<const Ray> rays) const {
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint32_t> primitive(rays.size());
    if (rays.empty()) return hits;
    scene_->closest(Rays::of(rays), {.t = {&hits[0].t, hits.size(), sizeof(Hit)}, .primitive = primitive});
    for (std::size_t i = 0; i < hits.size(); ++i) hits[i].primitive = static_cast<std::int32_t>(primitive[i]);
    return hits;
  }

  std::vector<SideResult> first_answers() const {
    say("from arrays to the first answer");
    std::vector<Runner> runners;
    for (const Side& side : sides_) runners.push_back({&side, &side.forms.front()});
    for (int round = 0; round < options_.repeat; ++round)
      for (Runner& runner : runners) {
        const Stopwatch clock;
        runner.side->first_answer(sets_.front());
        runner.wall.push_back(clock.wall());
        runner.cpu.push_back(clock.cpu());
      }
    std::vector<SideResult> results;
    for (const Runner& runner : runners) {
      results.push_back(runner.result());
      results.back().form.clear();
    }
    return results;
  }

  CellResult cell(const std::string& name, const QuerySet& set, std::size_t batch) {
    say(fmt::format("{}, {} rays, {} at a time", name, set.name, batch));
    const Question question = question_of(name);
    const std::span<const Side> sides =
        std::span(sides_).first(embree_answers(question) ? sides_.size() : n_own_);
    const Cell cell(question, set, batch, width_);
    std::vector<Runner> runners = cell.warm_up(sides, std::min(kWarmUps, options_.repeat));
    const bool whole = batch == set.size() && (question == Question::closest || question == Question::any);
    const std::vector<Ray> rays = whole ? set.structs() : std::vector<Ray>();
    std::vector<double> on_device;
    for (int round = 0; round < options_.repeat; ++round) {
      cell.round(runners);
      if (whole) on_device.push_back(on_device_->seconds(rays, question == Question::any));
    }
    CellResult result{name, set.name, batch, cell.calls(), {}, {}};
    for (const Runner& runner : runners) {
      result.sides.push_back(runner.result());
      if (question == Question::points) result.sides.back().form.clear();
    }
    if (whole) result.on_device = spread_of(on_device);
    return result;
  }

  const QueriesOptions& options_;
  std::string name_;
  const Working& working_;
  MeshArrays mesh_;
  double width_ = 0;
  DeviceOptions device_;
  QueriesRun run_;
  std::shared_ptr<const Scene> scene_;
  std::optional<OnDevice> on_device_;
  std::vector<QuerySet> sets_;
  std::vector<Side> sides_;
  std::size_t n_own_ = 0;  // of them kdray's, the first
};

}  // namespace

std::vector<QueriesRun> bench_queries(const QueriesOptions& options, const Progress<QueriesRun>& progress) {
  const QueriesOptions o = resolved(options);
  return run_each(o.scenes, progress,
                  [&](const std::string& name) { return QueriesScene(o, name, progress.working).run(); });
}

}  // namespace kdray::bench
