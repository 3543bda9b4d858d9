// What    The settings that `kdray bench accuracy` holds against each other, as data.
// Shape   A base of good quality (16 samples, depth 16, the default least weight), from which one thing at a
//         time is changed; then combinations: kdray's default depth with all numbers of samples, and drafts.
//         Adaptive sampling at targets a factor of two apart, so that what lies between them can be read off
//         the line through them.
#pragma once

#include <string>
#include <vector>

#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::bench {

struct Setting {
  std::string group, name, label;  // label: short, for a plot whose colours tell the groups
  int samples = 16, depth = 16;
  double adaptive_target = 0;  // above 0: adaptive sampling, whatever `samples`
  double min_weight = kDefaultMinWeight;
  // Lights end where they have become weaker than this; 0: nowhere but where the scene says.
  double light_reach = 0;
  Traversal traversal = Traversal::automatic;
  BuildQuality quality = BuildQuality::balanced;
  Precision precision = Precision::float32;
};

// Groups whose members all have the base's picture, bit for bit.
bool keeps_the_picture(const std::string& group);

// Element [0] is the base. The others are what makes a difference: on a CPU all traversals, with lights that
// fade their reach, and double where there is double.
struct SettingsWanted {
  bool cpu = true, fading_lights = false, double_precision = false, quick = false;
};
std::vector<Setting> accuracy_settings(const SettingsWanted& wanted);

RenderOptions render_options(const Setting& setting, int width, int height);

// Adaptive sampling's, at the base's depth.
bool is_adaptive(const std::string& group);

// Whether some light gets weaker with the distance, so that its reach can be limited.
bool has_fading_lights(const scene::Scene& scene);
// Ends each fading light at the distance from which on none of its colours is above `least`.
void limit_lights(scene::Scene& scene, double least);

}  // namespace kdray::bench
