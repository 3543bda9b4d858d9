// What    The scenes that settings are tried on: renders them, compares every bit with the reference, takes
//         times. And what a search found, and how it holds up against what kdray ships with: in words, and as
//         JSON.
// Shape   The reference is the picture of what kdray ships with, on this device, which has passed its
//         self-test. Scenes of one key (device/tuning/database.h) belong together: they share an entry.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "device/tuning/database.h"
#include "device/tuning/search.h"
#include "kdray/kdray.h"

namespace kdray::cli {

class TuneScene {
 public:
  // `name`: a file, or a scene that is built in (scene/generate/built_in.h). `check` sees it before anything
  // is done with it.
  TuneScene(const std::string& name, const DeviceOptions& device, const RenderOptions& render,
            const std::function<void(const scene::Scene&)>& check);

  const std::string& name() const { return name_; }
  tuning::Key key() const;  // of the scene, its device and schedule

  // Renders with these settings, and returns what is wrong with the picture; empty: nothing.
  std::string fault(const Tuning& tuning);
  double seconds(const Tuning& tuning);  // of a frame

 private:
  Picture render(const Tuning& tuning);

  std::string name_;
  RenderOptions options_;
  Renderer renderer_;
  Picture reference_;
};

// For tests: pictures made with this value of a setting have a wrong bit.
struct Injection {
  int Tuning::*setting = nullptr;
  int value = 0;
  bool hits(const Tuning& tuning) const { return setting && tuning.*setting == value; }
};

using TuneScenes = std::vector<std::unique_ptr<TuneScene>>;

// Returns a lab whose clock begins now; the scenes have to outlive it.
tuning::Lab make_lab(TuneScenes& scenes, const Injection& injection, std::function<void(double)> progress);

// Returns the scenes in groups of one key each.
std::vector<TuneScenes> by_key(TuneScenes scenes);

struct Tuned {
  std::vector<std::string> scenes;
  tuning::Found found;
};

// A scene rendered with the entry that render would take, against none.
struct Checked {
  std::string scene;
  Tuning settings;
  tuning::Rival rival;
};

std::string one_line_of(const Tuned& tuned);
std::string explain(const tuning::Found& found);  // what each setting bought, and what else was tried
std::string table_of(const std::vector<Checked>& checked);

nlohmann::json json_of(const std::vector<Tuned>& tuned, const std::vector<Checked>& checked);

// Returns all that was tried in T4 1.0.0, the format of Kernel Tuner's results. Times are of a frame of each
// scene together, in milliseconds; a setting of 0 is kdray's own choice.
nlohmann::json t4_of(const std::vector<Tuned>& tuned);

}  // namespace kdray::cli
