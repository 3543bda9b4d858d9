#include "bench/accuracy/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kdray::bench {

namespace {

constexpr int kDefaultDepth = 5;
constexpr const char* kSamples = "samples at depth 16";
constexpr const char* kAdaptive = "adaptive at depth 16";
constexpr const char* kDefaultDepths = "samples at depth 5";
constexpr const char* kSamePicture = "base, other traversal or tree: the same picture";

std::string spp(int n) {
  return fmt::format("{} spp", n);
}

std::string named(int samples, int depth) {
  return fmt::format("{} sample{}, depth {}", samples, samples == 1 ? "" : "s", depth);
}

class Settings {
 public:
  explicit Settings(const SettingsWanted& wanted) : wanted_(wanted) {}

  std::vector<Setting> all() {
    samples();
    adaptive();
    rules();
    same_picture();
    return std::move(all_);
  }

 private:
  // What is not essential is left out of a quick run.
  void put(const Setting& s, bool essential = true) {
    if (essential || !wanted_.quick) all_.push_back(s);
  }

  void samples() {
    put({.group = kSamples, .name = "16 samples, depth 16 (base)", .label = "base: 16 spp"});
    for (const int n : {1, 4, 64})
      put({.group = kSamples, .name = named(n, 16), .label = spp(n), .samples = n}, n < 64);
    put({.group = kDefaultDepths,
         .name = "1 sample, depth 5 (defaults)",
         .label = "defaults: 1 spp",
         .samples = 1,
         .depth = kDefaultDepth});
    for (const int n : {4, 16, 64})
      put({.group = kDefaultDepths,
           .name = named(n, kDefaultDepth),
           .label = spp(n),
           .samples = n,
           .depth = kDefaultDepth},
          false);
    for (const int n : {1, 4, 16})
      put({.group = "drafts: depth 3, least weight 0.02",
           .name = named(n, 3) + ", weight 0.02",
           .label = spp(n),
           .samples = n,
           .depth = 3,
           .min_weight = 0.02},
          n == 1);
  }

  void adaptive() {
    for (const double target : {0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125})
      put({.group = kAdaptive,
           .name = fmt::format("adaptive:{:g}, depth 16", target),
           .label = fmt::format("{:g}", target),
           .adaptive_target = target},
          target == 0.02 || target == 0.01);
  }

  void rules() {
    for (const int depth : {1, 2, 3, 8}) {
      const std::string name = fmt::format("depth {}", depth);
      put({.group = "base, other depth", .name = name, .label = name, .depth = depth}, depth == 1);
    }
    for (const double weight : {0.0, 0.004, 0.02, 0.1}) {
      const std::string name = fmt::format("weight {:g}", weight);
      put({.group = "base, other least weight", .name = name, .label = name, .min_weight = weight},
          weight == 0.02);
    }
    if (wanted_.double_precision)
      put({.group = "base, in double", .name = "double", .label = "double", .precision = Precision::float64});
    if (!wanted_.fading_lights) return;
    for (const double reach : {0.03, 0.05, 0.1, 0.2}) {
      const std::string name = fmt::format("lights to {:g}", reach);
      put({.group = "base, lights cut off", .name = name, .label = name, .light_reach = reach}, reach == 0.1);
    }
  }

  void same_picture() {
    const auto traversal = [&](const std::string& name, Traversal which, bool essential) {
      put({.group = kSamePicture, .name = name, .label = name, .traversal = which}, essential);
    };
    traversal("binary", Traversal::binary, true);
    traversal("wide", Traversal::wide, false);
    if (wanted_.cpu) {
      traversal("packet", Traversal::packet, false);
      traversal("batch", Traversal::batch, false);
    }
    put({.group = kSamePicture, .name = "fast tree", .label = "fast tree", .quality = BuildQuality::fast},
        false);
    put({.group = kSamePicture, .name = "best tree", .label = "best tree", .quality = BuildQuality::best},
        false);
  }

  SettingsWanted wanted_;
  std::vector<Setting> all_;
};

bool fades(const scene::Light& light) {
  return light.kind != scene::LightKind::directional && (light.attenuation.y > 0 || light.attenuation.z > 0);
}

// Where color / (c + l*d + q*d^2) = least.
double distance_of(const scene::Light& light, double least) {
  const double color = std::max({light.color.x, light.color.y, light.color.z});
  const double beyond = color / least - light.attenuation.x;  // = l*d + q*d^2
  if (beyond <= 0) return std::numeric_limits<float>::min();  // a range is above 0
  const double l = light.attenuation.y, q = light.attenuation.z;
  return 2 * beyond / (l + std::sqrt(l * l + 4 * q * beyond));
}

}  // namespace

std::vector<Setting> accuracy_settings(const SettingsWanted& wanted) {
  return Settings(wanted).all();
}

bool keeps_the_picture(const std::string& group) {
  return group == kSamePicture;
}

bool is_adaptive(const std::string& group) {
  return group == kAdaptive;
}

RenderOptions render_options(const Setting& setting, int width, int height) {
  return {.width = width,
          .height = height,
          .depth = setting.depth,
          .min_weight = setting.min_weight,
          .samples = setting.samples,
          .adaptive_target = setting.adaptive_target,
          .traversal = setting.traversal,
          .precision = setting.precision,
          .mode = Mode::pdprt};
}

bool has_fading_lights(const scene::Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(), fades);
}

void limit_lights(scene::Scene& scene, double least) {
  for (scene::Light& light : scene.lights)
    if (fades(light)) light.range = std::min(light.range, distance_of(light, least));
}

}  // namespace kdray::bench
