// What    What a page asks to see: a scene, from where, how large, and how it is rendered; and the options of
//         kdray that this comes to.
// Units   The scene's own, degrees, pixels.
// Shape   0, an empty name or a negative weight: as the command line or the scene has it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "kdray/kdray.h"

namespace kdray::view {

// Names, in the order of the enumerations Mode, Look and Traversal.
inline constexpr std::array<std::string_view, 3> kModes = {"auto", "pdprt", "odprt"};
inline constexpr std::array<std::string_view, 2> kLooks = {"plain", "studio"};
inline constexpr std::array<std::string_view, 5> kWalks = {"auto", "binary", "wide", "packet", "batch"};

enum class Samples { as_given, number, adaptive };

struct ViewRequest {
  std::size_t scene = 0;
  Camera camera;
  int width = 1024, height = 768;
  int depth = 0;
  double min_weight = -1, headlight = 0;
  std::optional<std::array<float, 3>> background;  // linear RGB, as View's
  std::optional<kdray::Look> look;                 // none: as the command line has it
  Samples samples = Samples::as_given;
  int n_samples = 1;    // Samples::number
  std::string channel;  // empty: the picture itself
  Mode mode = Mode::automatic;
  Traversal traversal = Traversal::automatic;
  int queues = 0;
};

// What the command line says, for all requests.
struct Settings {
  View view;  // camera, background
  RenderOptions render;
  DeviceOptions device;
  LoadOptions load;
  kdray::Look look = kdray::Look::studio;
  bool studio_instead = false;  // of a file's own camera and lights
};

// A studio that was asked for stands in for a file's own camera and lights.
struct ShownLook {
  kdray::Look look = kdray::Look::studio;
  bool instead = false;
};

View view_of(const ViewRequest& request, const Settings& settings);
// Returns the options of the finished picture.
RenderOptions render_of(const ViewRequest& request, const Settings& settings);
int queues_of(const ViewRequest& request, const Settings& settings);
ShownLook look_of(const ViewRequest& request, const Settings& settings);

// Returns the command that renders just this picture, bit for bit, wherever it runs. `scene`: a file.
std::string command_for(const ViewRequest& request, const Settings& settings, const std::string& scene);

}  // namespace kdray::view
