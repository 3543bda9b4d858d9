#include "bench/accuracy/bench.h"

#include <map>
#include <memory>
#include <utility>

#include "bench/accuracy/answers.h"
#include "bench/accuracy/exact.h"
#include "bench/accuracy/povray.h"
#include "bench/povray/povray.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

namespace {

constexpr int kPovrayRounds = 2;  // beside the one that is judged

class AccuracyScene {
 public:
  AccuracyScene(const AccuracyOptions& options, const AccuracyCalls& calls, const std::string& name)
      : options_(options),
        calls_(calls),
        exact_(exact_scene(name)),
        scene_(exact_ ? exact_->scene : load_scene(name)) {
    run_.scene = name;
  }

  AccuracyRun run() {
    Renderer& first = renderer({});
    const DeviceInfo device = first.statistics().device;
    run_.machine = machine_of(first.statistics());
    run_.n_primitives = scene_.primitive_count();
    run_.reference_in_double = device.double_precision;
    run_.reference_is_exact = exact_.has_value();
    make_reference(first);
    for (const Setting& s : accuracy_settings({.cpu = device.kind == "cpu",
                            .fading_lights = has_fading_lights(scene_),
                            .double_precision = run_.reference_in_double,
                            .quick = options_.quick}))
      run_.points.push_back({.group = s.group, .name = s.name, .label = s.label, .setting = s});
    judge_all();
    judge_povray();
    for (int round = 0; round < options_.repeat; ++round) time_all(round);
    finish();
    return std::move(run_);
  }

 private:
  // There is one renderer for each scene that a setting asks for: the same lights, the same tree.
  Renderer& renderer(const Setting& s) {
    auto& made = renderers_[{s.quality, s.light_reach}];
    if (made) return *made;
    scene::Scene copy = scene_;
    if (s.light_reach > 0) limit_lights(copy, s.light_reach);
    made = std::make_unique<Renderer>(Scene(std::move(copy)), TreeOptions{.quality = s.quality},
                                      DeviceOptions{.device = options_.device});
    return *made;
  }

  struct Rendered {
    Picture picture;
    double seconds = 0;
    std::optional<Taken> taken = {};
  };

  Rendered render(const Setting& s) {
    Renderer& r = renderer(s);
    Rendered rendered{r.render(render_options(s, options_.width, options_.height))};
    rendered.seconds = r.statistics().seconds.render;
    const std::optional<Statistics::Samples>& samples = r.statistics().samples;
    if (samples && samples->adaptive)
      rendered.taken = {samples->per_pixel, samples->adaptive->estimated_rmse};
    return rendered;
  }

  void make_reference(Renderer& r) {
    Reference reference = exact_ ? exact_->reference(options_.width, options_.height) : rendered_reference(r);
    run_.reference_seconds = reference.seconds, run_.reference_error = reference.own_error;
    reference_ = std::move(reference.image);
    calls_.picture(run_.scene, "reference", reference_);
  }

  Reference rendered_reference(Renderer& r) {
    calls_.working(run_.scene + (run_.reference_in_double
                                     ? ": reference"
                                     : ": reference, in float: the device does not compute in double"));
    return bench::make_reference(r, options_.width, options_.height, options_.reference_samples,
                                 run_.reference_in_double ? Precision::float64 : Precision::float32);
  }

  // `plain` is kdray's picture of one sample at depth 16.
  void make_povray(const image::Image& plain) {
    if (exact_ || !options_.povray || !has_povray() || !pov_has_words_for(scene_)) return;
    calls_.working(run_.scene + ": POV-Ray");
    povray_ = std::make_unique<PovrayPoints>(scene_, reference_, plain, run_.machine.cores, options_.quick);
    run_.povray.emplace();
    run_.povray->model_difference = povray_->model_difference();
    run_.povray->has_own_reference = povray_->has_own_reference();
    if (povray_->has_own_reference()) calls_.picture(run_.scene, "POV-Ray reference", povray_->reference());
    for (const PovraySetting& s : povray_->settings())
      run_.povray->points.push_back({.group = kPovray, .name = s.name, .label = s.name});
  }

  void judge(AccuracyPoint& point, const image::Image& reference, const image::Image& image,
             const image::Image& base) {
    point.error = image::compare(reference, image);
    point.change = image::compare(base, image).rmse;
    calls_.picture(run_.scene, point.group == kPovray ? "POV-Ray " + point.name : point.name,
                   error_picture(reference, image));
  }

  void judge_all() {
    calls_.working(run_.scene + ": pictures");
    image::Image base;
    for (AccuracyPoint& point : run_.points) {
      const Rendered rendered = render(point.setting);
      const image::Image image = shown(image_of(rendered.picture));
      point.taken = rendered.taken;
      if (base.pixels.empty()) base = image;
      judge(point, reference_, image, base);
    }
  }

  void judge_povray() {
    Setting plain;
    plain.samples = 1;
    make_povray(shown(image_of(render(plain).picture)));
    if (!povray_) return;
    povray_seconds_.resize(povray_->settings().size());
    for (std::size_t i = 0; i < povray_seconds_.size(); ++i) {
      const Povray::Traced traced = povray_->trace(i);
      povray_seconds_[i].push_back(traced.seconds);  // a process of its own each time: nothing gets warm
      judge(run_.povray->points[i], povray_->reference(), traced.image, traced.image);
    }
  }

  void time_all(int round) {
    if (round == 0) {
      seconds_.resize(run_.points.size());
      calls_.working(run_.scene + ": times");
    }
    // This frame is not counted: after POV-Ray's processes a frame takes up to a third longer.
    render(run_.points.front().setting);
    for (std::size_t i = 0; i < run_.points.size(); ++i)
      seconds_[i].push_back(render(run_.points[i].setting).seconds);
    if (!povray_ || round >= kPovrayRounds) return;
    for (std::size_t i = 0; i < povray_seconds_.size(); ++i)
      povray_seconds_[i].push_back(povray_->trace(i).seconds);
  }

  void finish() {
    const auto set = [](std::vector<AccuracyPoint>& points, const std::vector<std::vector<double>>& seconds) {
      for (std::size_t i = 0; i < points.size(); ++i) points[i].seconds = spread_of(seconds[i]);
      mark_front(points);
    };
    set(run_.points, seconds_);
    if (povray_) set(run_.povray->points, povray_seconds_);
  }

  const AccuracyOptions& options_;
  const AccuracyCalls& calls_;
  std::optional<ExactScene> exact_;
  scene::Scene scene_;
  std::map<std::pair<BuildQuality, double>, std::unique_ptr<Renderer>> renderers_;
  image::Image reference_;
  std::unique_ptr<PovrayPoints> povray_;
  std::vector<std::vector<double>> seconds_, povray_seconds_;  // [point]
  AccuracyRun run_;
};

}  // namespace

std::size_t count_unlike_base(std::span<const AccuracyRun> runs) {
  return count_over(runs, [](const AccuracyRun& run) {
    return count_over(run.points,
                      [](const AccuracyPoint& p) { return keeps_the_picture(p.group) && p.change != 0; });
  });
}

std::vector<AccuracyRun> bench_accuracy(const AccuracyOptions& options, const AccuracyCalls& calls) {
  std::vector<AccuracyRun> runs;
  for (const std::string& name : options.scenes) {
    runs.push_back(AccuracyScene(options, calls, name).run());
    calls.done(runs);
  }
  return runs;
}

}  // namespace kdray::bench
