#include "bench/ablation/bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include "accel/flatten/features.h"
#include "api/hooks.h"
#include "base/error.h"
#include "base/timer.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

namespace {

// A definition that nothing reads and no program was ever built with: caches of programs don't know it.
std::string unheard_of() {
  static int n = 0;
  return fmt::format("-DKDRAY_ANEW={}_{}_{}", ::getpid(),
                     std::chrono::system_clock::now().time_since_epoch().count(), n++);
}

struct Frame {
  Picture picture;
  double wall = 0, render = 0;  // seconds of the call; of the frame alone
  std::map<std::string, std::uint64_t> rays;

  double beside() const { return wall - render; }
};

class AblationScene {
 public:
  AblationScene(const AblationOptions& options, const std::string& name)
      : options_(options),
        name_(name),
        scene_(Scene(load_scene(name)), {.binary_form = false}),
        renderer_(api::make_renderer(scene_, {.device = options.device}, {.build_options = unheard_of()})) {}

  AblationRun run() {
    warm_up();
    AblationRow usual = first_frames({.name = "nothing"});
    AblationRun run = describe();
    run.rows.push_back(std::move(usual));
    for (const Ablation& a : wanted_of(ablations_for(mask_of(run.on)))) run.rows.push_back(first_frames(a));
    std::vector<std::vector<double>> seconds(run.rows.size()), ratios(run.rows.size());
    for (int round = 0; round < options_.repeat; ++round)
      for (std::size_t i = 1; i < run.rows.size(); ++i) {
        seconds[0].push_back(frame(run.rows[0].ablation).render);
        seconds[i].push_back(frame(run.rows[i].ablation).render);
        ratios[i].push_back(seconds[i].back() / seconds[0].back());
      }
    ratios[0] = {1.0};
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      run.rows[i].seconds = spread_of(seconds[i]);
      run.rows[i].ratio = spread_of(ratios[i]);
    }
    return run;
  }

 private:
  std::vector<Ablation> wanted_of(const std::vector<Ablation>& all) const {
    if (options_.only.empty()) return all;
    std::vector<Ablation> wanted;
    std::vector<std::string> names;
    for (const Ablation& ablation : all) names.push_back(ablation.name);
    for (const std::string& name : options_.only) {
      const auto place = std::ranges::find(all, name, &Ablation::name);
      if (place == all.end())
        throw Error(ErrorCode::usage, fmt::format("--only '{}': of {} this can be taken away: {}", name,
                                                  name_, fmt::join(names, ", ")));
      wanted.push_back(*place);
    }
    return wanted;
  }

  // To be called after a frame: which features are on is known from then on.
  AblationRun describe() const {
    const Statistics& s = renderer_.statistics();
    return {name_, s.device.name, s.scene.primitives, s.features.on, s.features.off, {}};
  }

  static layout::Features mask_of(const std::vector<std::string>& names) {
    layout::Features mask = 0;
    for (const flatten::Feature& f : flatten::features())
      if (std::find(names.begin(), names.end(), f.name) != names.end()) mask |= f.bit;
    return mask;
  }

  Frame frame(const Ablation& ablation) {
    const Timer timer;
    Frame f;
    api::keep(renderer_, ablation.keep);
    f.picture = renderer_.render(with(ablation, {.width = options_.width,
                                                 .height = options_.height,
                                                 .depth = options_.depth,
                                                 .samples = 1,
                                                 .mode = Mode::pdprt}));
    f.wall = timer.seconds();
    f.rays = rays_by_kind(renderer_.statistics());
    f.render = renderer_.statistics().seconds.render;
    return f;
  }

  // The first call compiles, and a driver may finish only at the first launch; neither counts as rendering.
  // So the time to compile is what the first call takes beside rendering, less what the second one does.
  AblationRow first_frames(const Ablation& ablation) {
    const bool usual = ablation.kind == Ablation::Kind::none, compiles = usual || ablation.keep != 0;
    const Frame first = frame(ablation), second = frame(ablation);
    AblationRow row;
    row.ablation = ablation, row.rays = second.rays;
    if (compiles) row.compile_seconds = std::max(0.0, first.beside() - second.beside());
    if (usual) usual_ = second.picture;
    compare(second.picture, row);
    return row;
  }

  // The scene goes to the device before the first frame that counts, by a ray.
  void warm_up() {
    const Ray ray = {{0, 0, 0}, 0, {0, 0, 1}, 1};
    renderer_.trace(std::span(&ray, 1));
  }

  void compare(const Picture& picture, AblationRow& row) const {
    for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
      const float a = usual_.rgb[i], b = picture.rgb[i];
      if (std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b)) continue;
      ++row.n_differing;
      row.largest_difference = std::max(row.largest_difference, std::abs(double{a} - double{b}));
    }
  }

  const AblationOptions& options_;
  std::string name_;
  PreparedScene scene_;
  Renderer renderer_;
  Picture usual_;
};

}  // namespace

std::vector<AblationRun> bench_ablation(const AblationOptions& options,
                                        const Progress<AblationRun>& progress) {
  return run_scenes<AblationScene>(options, progress);
}

std::size_t count_inexact(std::span<const AblationRun> runs) {
  return count_over(runs, [](const AblationRun& run) {
    return count_over(run.rows, [](const AblationRow& r) { return r.ablation.exact && r.n_differing > 0; });
  });
}

}  // namespace kdray::bench
