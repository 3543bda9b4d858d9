#include "apps/cli/tune_lab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <future>

#include "base/timer.h"
#include "scene/generate/built_in.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

// Returns the first pixel that differs in a bit; empty: none.
std::string difference(const Picture& picture, const Picture& reference) {
  if (picture.width != reference.width || picture.height != reference.height) return "another size";
  const std::size_t n = picture.rgb.size();
  if (n != reference.rgb.size()) return "values are missing";
  if (std::memcmp(picture.rgb.data(), reference.rgb.data(), n * sizeof(float)) == 0) return "";
  for (std::size_t i = 0; i < n; ++i)
    if (std::memcmp(&picture.rgb[i], &reference.rgb[i], sizeof(float)) != 0)
      return fmt::format("pixel {}, {} differs", i / 3 % static_cast<std::size_t>(picture.width),
                         i / 3 / static_cast<std::size_t>(picture.width));
  return "";
}

Scene load_checked(const std::string& name, const std::function<void(const scene::Scene&)>& check) {
  scene::Scene scene = generate::load_scene(name);
  check(scene);
  return Scene(std::move(scene));
}

}  // namespace

TuneScene::TuneScene(const std::string& name, const DeviceOptions& device, const RenderOptions& render,
                     const std::function<void(const scene::Scene&)>& check)
    : name_(name),
      options_(render),
      renderer_(PreparedScene(load_checked(name, check),
                              {.binary_form = takes_binary_form(render.traversal, render.precision)}),
                device),
      reference_(TuneScene::render({})) {}

tuning::Key TuneScene::key() const {
  const Statistics::DeviceTuning& tuning = renderer_.statistics().tuning;
  return {tuning.device, tuning.driver, tuning.kernels, tuning.schedule, tuning.features};
}

Picture TuneScene::render(const Tuning& tuning) {
  renderer_.tune(tuning);
  return renderer_.render(options_);
}

std::string TuneScene::fault(const Tuning& tuning) {
  const std::string differs = difference(render(tuning), reference_);
  return differs.empty() ? "" : name_ + ": " + differs;
}

double TuneScene::seconds(const Tuning& tuning) {
  render(tuning);
  return renderer_.statistics().seconds.render;
}

namespace {

// Each scene has a thread, so that compilers work side by side; this is not timed.
std::string first_fault(TuneScenes& scenes, const Tuning& tuning) {
  std::vector<std::future<std::string>> looks;
  for (const auto& scene : scenes)
    looks.push_back(std::async(std::launch::async, [&scene, &tuning] { return scene->fault(tuning); }));
  std::string first;
  for (auto& look : looks)
    if (const std::string fault = look.get(); first.empty()) first = fault;
  return first;
}

}  // namespace

tuning::Lab make_lab(TuneScenes& scenes, const Injection& injection, std::function<void(double)> progress) {
  tuning::Lab lab;
  lab.fault = [&scenes, injection](const Tuning& tuning) {
    return injection.hits(tuning) ? "told to be wrong" : first_fault(scenes, tuning);
  };
  lab.measure = [&scenes](const Tuning& tuning) {
    std::vector<double> seconds;
    for (const auto& scene : scenes) seconds.push_back(scene->seconds(tuning));
    return seconds;
  };
  lab.now = [timer = Timer()] { return timer.seconds(); };
  lab.progress = std::move(progress);
  return lab;
}

std::vector<TuneScenes> by_key(TuneScenes scenes) {
  std::vector<TuneScenes> groups;
  for (auto& scene : scenes) {
    const auto same = std::ranges::find_if(
        groups, [&](const TuneScenes& group) { return group.front()->key() == scene->key(); });
    TuneScenes& group = same == groups.end() ? groups.emplace_back() : *same;
    group.push_back(std::move(scene));
  }
  return groups;
}

namespace {

std::string value_text(int value) {
  return value == 0 ? "own" : std::to_string(value);
}

// "4 % faster", "1 % slower".
std::string speed_text(double ratio) {
  const double percent = 100 * (1 - ratio);
  return fmt::format("{:.1f} % {}", percent < 0 ? -percent : percent, percent < 0 ? "slower" : "faster");
}

std::string explain_rival(const tuning::Setting& setting, const tuning::Rival& rival) {
  const std::string untimed = rival.fault.empty() ? "not timed, the budget was spent" : rival.fault;
  const std::string what = rival.ratios.empty() ? untimed : speed_text(rival.ratio());
  return fmt::format("    {:>6}  {:<9}  {}, {} round{}\n", value_text(rival.tuning.*setting.value),
                     tuning::name_of(rival.verdict), what, rival.ratios.size(),
                     rival.ratios.size() == 1 ? "" : "s");
}

nlohmann::json settings_json(const Tuning& tuning) {
  nlohmann::json json = nlohmann::json::object();
  for (const tuning::Setting& s : tuning::settings())
    if (tuning.*s.value != 0) json[std::string(s.name)] = tuning.*s.value;
  return json;
}

nlohmann::json step_json(const tuning::Step& step) {
  nlohmann::json rivals = nlohmann::json::array();
  for (const tuning::Rival& r : step.rivals)
    rivals.push_back({{"value", r.tuning.*step.setting->value},
                      {"verdict", tuning::name_of(r.verdict)},
                      {"fault", r.fault},
                      {"ratio", r.ratio()},
                      {"rounds", r.ratios.size()}});
  return {{"setting", step.setting->name}, {"before", step.before},   {"after", step.after},
          {"ratio", step.ratio},           {"seconds", step.seconds}, {"rivals", rivals}};
}

}  // namespace

std::string one_line_of(const Tuned& tuned) {
  const tuning::Found& f = tuned.found;
  return fmt::format("{}: {}, {} in {:.1f} s ({} races; {})", fmt::join(tuned.scenes, " "),
                     tuning::in_words(f.best), f.kept_start ? "nothing surely faster" : speed_text(f.ratio),
                     f.seconds, f.steps.size(), f.ended_by);
}

std::string explain(const tuning::Found& found) {
  std::string text;
  for (const tuning::Step& step : found.steps) {
    const std::string bought = step.after == step.before
                                   ? "stays"
                                   : fmt::format("-> {}: {}", value_text(step.after), speed_text(step.ratio));
    text += fmt::format("  {} ({}): {} {}, in {:.1f} s\n", step.setting->name, step.setting->what,
                        value_text(step.before), bought, step.seconds);
    for (const tuning::Rival& r : step.rivals) text += explain_rival(*step.setting, r);
  }
  if (!found.last.ratios.empty())
    text +=
        fmt::format("  the last race, against the start: {}, {} rounds; {}\n", speed_text(found.last.ratio()),
                    found.last.ratios.size(), found.kept_start ? "the start stays" : "kept");
  return text;
}

std::string table_of(const std::vector<Checked>& checked) {
  std::string text =
      fmt::format("  {:<16} {:>10} {:>9} {:>9}  {}\n", "scene", "time", "least", "most", "settings");
  for (const Checked& c : checked)
    text += fmt::format(
        "  {:<16} {:>10.3f} {:>9.3f} {:>9.3f}  {}\n", c.scene, c.rival.ratio(),
        std::ranges::min(c.rival.ratios), std::ranges::max(c.rival.ratios),
        c.settings == Tuning{} ? "kdray's own on both sides: noise" : tuning::in_words(c.settings));
  return text;
}

nlohmann::json json_of(const std::vector<Tuned>& tuned, const std::vector<Checked>& checked) {
  nlohmann::json json = {{"tuned", nlohmann::json::array()}, {"checked", nlohmann::json::array()}};
  for (const Tuned& t : tuned) {
    nlohmann::json steps = nlohmann::json::array();
    for (const tuning::Step& step : t.found.steps) steps.push_back(step_json(step));
    json["tuned"].push_back({{"scenes", t.scenes},
                             {"settings", settings_json(t.found.best)},
                             {"ratio", t.found.ratio},
                             {"seconds", t.found.seconds},
                             {"ended_by", t.found.ended_by},
                             {"last_race", t.found.last.ratios},
                             {"races", steps}});
  }
  for (const Checked& c : checked)
    json["checked"].push_back({{"scene", c.scene},
                               {"settings", settings_json(c.settings)},
                               {"ratio", c.rival.ratio()},
                               {"ratios", c.rival.ratios}});
  return json;
}

namespace {

nlohmann::json t4_result(const tuning::Rival& rival) {
  nlohmann::json configuration = nlohmann::json::object(), runtimes = nlohmann::json::array();
  for (const tuning::Setting& s : tuning::settings())
    configuration[std::string(s.name)] = rival.tuning.*s.value;
  for (const double seconds : rival.seconds) runtimes.push_back(1e3 * seconds);
  const bool wrong = rival.verdict == tuning::Verdict::wrong, timed = !rival.seconds.empty();
  nlohmann::json measurements = nlohmann::json::array();
  if (timed)
    measurements = {{{"name", "time"}, {"value", 1e3 * median(rival.seconds)}, {"unit", "ms"}},
                    {{"name", "time_over_best_before"}, {"value", rival.ratio()}, {"unit", ""}}};
  return {{"configuration", configuration},
          {"objectives", {"time"}},
          {"times", {{"runtimes", runtimes}}},
          {"invalidity", wrong ? "correctness" : (timed ? "correct" : "timeout")},
          {"correctness", wrong ? 0 : 1},
          {"measurements", measurements}};
}

}  // namespace

nlohmann::json t4_of(const std::vector<Tuned>& tuned) {
  nlohmann::json results = nlohmann::json::array();
  for (const Tuned& t : tuned) {
    for (const tuning::Step& step : t.found.steps)
      for (const tuning::Rival& rival : step.rivals) results.push_back(t4_result(rival));
    if (!t.found.last.seconds.empty()) results.push_back(t4_result(t.found.last));
  }
  return {{"schema_version", "1.0.0"}, {"results", results}};
}

}  // namespace kdray::cli
