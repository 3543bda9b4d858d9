#include "bench/frames/bench.h"

#include <algorithm>
#include <memory>

#include "bench/embree/embree.h"
#include "bench/povray/povray.h"
#include "bench/workload/scenes.h"
#include "kdray/kdray.h"
#include "scene/generate/generate.h"

namespace kdray::bench {

namespace {

constexpr int kPovrayRounds = 3;

// A frame's time and that of its stages.
std::map<std::string, double> times_of_frame(const Statistics::Seconds& s) {
  return {{"render", s.render},
          {"trace", s.trace},
          {"shade", s.shade},
          {"admit", s.admit.value_or(0)},
          {"add", s.add.value_or(0)}};
}

// Scenes whose materials are NFF's, and so POV-Ray's as well.
bool is_nff(const std::string& name) {
  if (name.find(".nff") != std::string::npos) return true;
  const auto all = generate::generators();
  return std::any_of(all.begin(), all.end(), [&](const generate::Generator& g) { return g.name == name; });
}

class FrameBench {
 public:
  FrameBench(const FramesOptions& options, const std::string& name)
      : options_(options), name_(name), scene_(load_scene(name)) {
    renderer_ = std::make_unique<Renderer>(scene_, TreeOptions{.binary_form = false},
                                           DeviceOptions{.device = options.device});
    machine_ = machine_of(renderer_->statistics());
    if (!is_nff(name)) return;
    if (options.embree) make_embree();
    if (has_povray())
      povray_ = std::make_unique<Povray>(scene_.model(), options.width, options.height, options.depth,
                                         kDefaultMinWeight);
  }

  FrameResult run() {
    for (int round = -1; round < options_.repeat; ++round) run_round(round);
    return result();
  }

 private:
  RenderOptions render_options() const {
    return {.width = options_.width, .height = options_.height, .depth = options_.depth};
  }

  // A frame of kdray's tells from which weight on it makes rays.
  void make_embree() {
    renderer_->render(render_options());
    const float threshold = renderer_->statistics().frame->spawn_threshold;
    embree_ = embree_frames(scene_.model(),
                            {options_.width, options_.height, options_.depth, threshold, machine_.cores});
    embree_seconds_.resize(embree_.size());
    n_embree_rays_.resize(embree_.size());
  }

  // Round -1 warms up and is not counted.
  void run_round(int round) {
    renderer_->render(render_options());
    const Statistics& statistics = renderer_->statistics();
    for (std::size_t i = 0; i < embree_.size(); ++i) {
      const EmbreePicture picture = embree_[i].render();
      if (round >= 0) embree_seconds_[i].push_back(picture.seconds);
      n_embree_rays_[i] = picture.n_rays;
    }
    const bool with_povray = povray_ && round < kPovrayRounds;
    const double povray = with_povray ? povray_->trace_seconds(machine_.cores) : 0;
    if (round < 0) return;
    for (const auto& [stage, seconds] : times_of_frame(statistics.seconds))
      seconds_[stage].push_back(seconds);
    rays_ = rays_by_kind(statistics);
    if (with_povray) povray_seconds_.push_back(povray);
  }

  FrameResult result() const {
    const scene::Scene& model = scene_.model();
    FrameResult r;
    r.scene = name_;
    r.n_primitives = kind_counts(model);
    r.machine = machine_;
    r.rays = rays_;
    r.seconds = spread_of(seconds_.at("render"));
    for (const auto& [stage, seconds] : seconds_)
      if (stage != "render") r.stages.emplace_back(stage, spread_of(seconds));
    for (std::size_t i = 0; i < embree_.size(); ++i)
      r.embree.push_back({embree_[i].name, spread_of(embree_seconds_[i]), n_embree_rays_[i]});
    if (povray_) r.povray_seconds = spread_of(povray_seconds_);
    return r;
  }

  const FramesOptions& options_;
  std::string name_;
  Scene scene_;
  std::unique_ptr<Renderer> renderer_;
  Machine machine_;
  std::map<std::string, std::uint64_t> rays_;
  std::vector<EmbreeFrames> embree_;
  std::vector<std::vector<double>> embree_seconds_;
  std::vector<std::uint64_t> n_embree_rays_;
  std::unique_ptr<Povray> povray_;
  std::map<std::string, std::vector<double>> seconds_;
  std::vector<double> povray_seconds_;
};

}  // namespace

const EmbreeFrame* FrameResult::fastest_embree() const {
  const auto found =
      std::ranges::min_element(embree, {}, [](const EmbreeFrame& frame) { return frame.seconds.median; });
  return found == embree.end() ? nullptr : &*found;
}

std::vector<FrameResult> bench_frames(const FramesOptions& options, const Progress<FrameResult>& progress) {
  return run_scenes<FrameBench>(options, progress);
}

}  // namespace kdray::bench
