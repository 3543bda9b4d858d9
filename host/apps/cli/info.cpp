// What    kdray info: what a scene holds, the tree kdray builds for it, the memory both take. Needs no
//         device.
// Units   world units; bytes as held by this process; the tree's cost in units of its own constants.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "accel/flatten/flatten.h"
#include "accel/flatten/wide.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/statistics.h"
#include "accel/prepare/prepared.h"
#include "apps/cli/command.h"
#include "apps/cli/info_report.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/scene_input.h"
#include "base/process_memory.h"
#include "base/timer.h"
#include "scene/model/geometry.h"

namespace kdray::cli {

namespace {

// ---- The report as text for people

constexpr std::size_t kShown = 12;  // the rest is counted; --json has them all

std::string line(std::string_view name, std::string_view value) {
  return fmt::format("{:<12} {}\n", name, value);
}

std::string vector_text(const Json& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// Returns a colour, or one number where its channels are alike; empty for black.
std::string color_text(const char* name, const Json& v) {
  const double r = v[0], g = v[1], b = v[2];
  if (r == 0 && g == 0 && b == 0) return "";
  if (r == g && g == b) return fmt::format("{} {:.3g}", name, r);
  return fmt::format("{} ({:.3g}, {:.3g}, {:.3g})", name, r, g, b);
}

std::string primitives_text(const Json& p) {
  const std::uint64_t zero_area = p["stitches"], dropped = p["dropped_degenerate"];
  std::string text = fmt::format(
      "{}: {}", p["total"].get<std::uint64_t>(),
      primitives::counts_in_words([&](auto kind) { return p[kind.kNames].template get<std::uint64_t>(); }));
  if (zero_area > 0) text += fmt::format("; {} of the triangles without area", zero_area);
  if (dropped > 0) text += fmt::format("; {} degenerate dropped", dropped);
  return text;
}

std::string background_text(const Json& b) {
  if (b.is_array()) return vector_text(b);
  if (b["type"] == "gradient") return fmt::format("a gradient of {} stops", b["stops"].get<std::size_t>());
  if (!b.contains("file")) return "a picture all around";
  return fmt::format("{}, {}x{} all around", one_line(b["file"].get<std::string>()), b["size"][0].get<int>(),
                     b["size"][1].get<int>());
}

std::string camera_text(const Json& c) {
  if (c.is_null()) return "none";
  const std::string lens = c["ortho_width"].is_null()
                               ? fmt::format("{:.4g} degrees high", c["vertical_fov_degrees"].get<double>())
                               : fmt::format("orthographic, {:.4g} wide", c["ortho_width"].get<double>());
  const auto n = c["in_file"].get<std::size_t>();
  const auto aperture = c["aperture"].get<double>();
  const std::string blur =
      aperture > 0 ? fmt::format(", a lens of {:.4g} in focus at {:.4g}", aperture, c["focus"].get<double>())
                   : "";
  return fmt::format("from {} at {}, {}{}{}", vector_text(c["from"]), vector_text(c["at"]), lens, blur,
                     n > 1 ? fmt::format("; the first of {}", n) : "");
}

std::string material_text(const Json& m) {
  std::string text = fmt::format("{} primitives", m["primitives"].get<std::uint64_t>());
  if (m.contains("name")) text = fmt::format("'{}', {}", m["name"].get<std::string>(), text);
  for (const char* const term : {"emission", "ambient", "diffuse", "specular", "reflect", "transmit"})
    if (const std::string color = color_text(term, m[term]); !color.empty()) text += ", " + color;
  if (m["specular"] != Json::array({0.0, 0.0, 0.0}))
    text += fmt::format(", shine {:.4g}", m["shine"].get<double>());
  if (m["transmit"] != Json::array({0.0, 0.0, 0.0}))
    text += fmt::format(", index {:.4g}", m["index"].get<double>());
  return text;
}

std::string materials_text(const Json& materials) {
  std::string text = line("materials", fmt::format("{}", materials.size()));
  for (std::size_t i = 0; i < std::min(materials.size(), kShown); ++i)
    text += line("", fmt::format("{}: {}", i, material_text(materials[i])));
  if (materials.size() > kShown)
    text += line("", fmt::format("and {} more (--json shows all)", materials.size() - kShown));
  return text;
}

std::string parts_text(const Json& parts, std::size_t n_parts) {
  if (n_parts == 0) return "";
  std::string text = line("parts", fmt::format("{}", n_parts));
  for (const Json& p : parts) {
    const std::uint64_t primitives = p["primitives"], instances = p.value("instances", std::uint64_t{0});
    text += line("", fmt::format("'{}', {}", p["name"].get<std::string>(),
                                 instances > 0 ? fmt::format("{} instances", instances)
                                               : fmt::format("{} primitives", primitives)));
  }
  if (n_parts > parts.size())
    text += line("", fmt::format("and {} more (--json shows all)", n_parts - parts.size()));
  return text;
}

std::string lights_text(const Json& lights, bool of_file) {
  std::string text = line("lights", fmt::format("{}{}", of_file ? "" : "none: made up, ", lights.size()));
  for (std::size_t i = 0; i < std::min(lights.size(), kShown); ++i) {
    const Json& l = lights[i];
    const bool placed = l.contains("position");
    text += line(
        "", fmt::format("{} {} {}, {}", l["kind"].get<std::string>(), placed ? "at" : "towards",
                        vector_text(l[placed ? "position" : "direction"]), color_text("color", l["color"])));
  }
  return text;
}

// "0: 12, 1: 40, 2: 7, 8+: 3": how many leaves hold how many references.
std::string leaf_sizes_text(const Json& sizes) {
  std::string text;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const std::uint64_t count = sizes[k];
    if (count == 0) continue;
    const bool open_end = k + 1 == sizes.size();
    text += fmt::format("{}{}{}: {}", text.empty() ? "" : ", ", k, open_end ? "+" : "", count);
  }
  return text;
}

std::string tree_text(const Json& t) {
  std::string text;
  text += line("tree", fmt::format("built {}, {} nodes: {} inner, {} leaves ({} empty); {} groups in leaves",
                                   t["build"].get<std::string>(), t["nodes"].get<std::uint64_t>(),
                                   t["inner_nodes"].get<std::uint64_t>(), t["leaves"].get<std::uint64_t>(),
                                   t["empty_leaves"].get<std::uint64_t>(), t["groups"].get<std::uint64_t>()));
  text += line("  depth", fmt::format("{} at most, {:.2f} on average", t["max_depth"].get<int>(),
                                      t["mean_leaf_depth"].get<double>()));
  text +=
      line("  references", fmt::format("{}, {:.2f} for each primitive, {} in the largest leaf",
                                       t["references"].get<std::uint64_t>(), t["duplication"].get<double>(),
                                       t["largest_leaf"].get<std::uint64_t>()));
  text += line("  leaf sizes", leaf_sizes_text(t["leaves_by_size"]));
  text +=
      line("  SAH cost",
           fmt::format("{:.2f} expected for a ray that meets the bounds, {:.2f} for one that skips what lies "
                       "outside of each node's contents",
                       t["sah_cost"].get<double>(), t["tight_cost"].get<double>()));
  return text;
}

// "vertices 3.1 MB, triangles 12 MB": what takes a hundredth of all or more, each array by its name.
std::string arrays_text(const Json& arrays, std::uint64_t all) {
  std::string text;
  for (const auto& [name, array] : arrays.items())
    if (const std::uint64_t bytes = array; bytes > 0 && bytes >= all / 100)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", with_spaces(name), bytes_in_words(bytes));
  return text;
}

std::string memory_text(const Json& m) {
  const auto bytes = [&m](const char* name) { return bytes_in_words(m[name].get<std::uint64_t>()); };
  std::string text = line("memory", fmt::format("{} on the device ({} flat, {} wide)", bytes("final_bytes"),
                                                bytes("flat_bytes"), bytes("wide_bytes")));
  for (const auto& [name, arrays] : m["arrays"].items()) {
    const std::uint64_t all = m[name + "_bytes"];
    text += line("  " + name, fmt::format("{}: {}", bytes_in_words(all), arrays_text(arrays, all)));
  }
  const Json& build = m["build_peak_bytes"];
  text += line("  at most",
               fmt::format("{}the process {}",
                           build.is_null() ? ""
                                           : "building " + bytes_in_words(build.get<std::uint64_t>()) +
                                                 " beyond scene and geometry, ",
                           bytes("process_peak_bytes")));
  return text;
}

std::string report_as_text(const Json& r, std::size_t n_parts) {
  const Json& bounds = r["bounds"];
  std::string text = one_line(r["scene"].get<std::string>()) + "\n";
  text += line("primitives", primitives_text(r["primitives"]));
  text += line("bounds", bounds.is_null() ? "none: the scene is empty"
                                          : vector_text(bounds["min"]) + " to " + vector_text(bounds["max"]));
  // What is made up for the plain look is of no interest where pictures are of a studio.
  const bool has_camera = r["camera"].is_object() && !r["camera"]["made_up"],
             has_lights = !r["lights_made_up"];
  const bool in_studio = !has_camera && !has_lights && !bounds.is_null();
  const char* const none = in_studio ? "none: pictures show it in a studio" : "none: made up, ";
  text += line("camera", (has_camera ? "" : none) + (in_studio ? "" : camera_text(r["camera"])));
  text += line("background", background_text(r["background"]));
  text += (in_studio ? line("lights", "none") : lights_text(r["lights"], has_lights)) +
          materials_text(r["materials"]) + parts_text(r["parts"], n_parts) + tree_text(r["tree"]) +
          memory_text(r["memory"]);
  text += line("time", fmt::format("load {}, build {}, flatten {}",
                                   seconds_in_words(r["seconds"]["load"].get<double>()),
                                   seconds_in_words(r["seconds"]["build"].get<double>()),
                                   seconds_in_words(r["seconds"]["flatten"].get<double>())));
  return text;
}

// ---- The command

struct InfoArgs {
  SceneInput scene;
  TreeOptions tree;
  bool json = false;
};

// A tree and what a device gets of it, with the time that each took.
struct Forms {
  kdtree::Tree tree;
  flatten::FlatScene flat;
  flatten::WideForm wide;
  double build_seconds = 0, flatten_seconds = 0;

  std::size_t bytes() const { return flat.bytes() + wide.bytes(); }
};

Forms build_forms(const scene::Scene& scene, const scene::Geometry& geometry,
                  const kdtree::BuildConfig& config, bool binary_form) {
  Forms forms;
  Timer step;
  forms.tree = kdtree::build(geometry, config);
  forms.build_seconds = step.seconds();
  step.restart();
  forms.flat = flatten::flatten(scene, geometry, forms.tree, binary_form);
  forms.wide = flatten::make_wide(forms.tree, forms.flat, flatten::choose_block(forms.tree));
  forms.flatten_seconds = step.seconds();
  return forms;
}

// Builds both forms where there is no limit, since `info` reports on both; with one, what `render` would
// build.
Forms build_forms_within(const scene::Scene& scene, const scene::Geometry& geometry,
                         const kdtree::BuildConfig& config, std::uint64_t most_bytes) {
  if (most_bytes == 0) return build_forms(scene, geometry, config, true);
  std::string warning;
  Forms forms = prepare::make_within(
      config, most_bytes,
      [&](const kdtree::BuildConfig& coarser) { return build_forms(scene, geometry, coarser, false); },
      warning);
  if (!warning.empty()) say(warning);
  return forms;
}

int run(const InfoArgs& o) {
  check_scene_input(o.scene);
  Timer step;
  const scene::Scene scene = load_model(o.scene);
  const double load_seconds = step.seconds();
  for (const std::string& warning : scene.warnings) say(warning);
  if (!scene.instances.empty())
    say(fmt::format("what is told is of the scene without its {} instances of {} meshes",
                    scene.instances.size(), scene.meshes.size()));

  step.restart();
  const scene::Geometry geometry = scene::make_geometry(scene);
  const double geometry_seconds = step.seconds();
  TreeOptions usual = o.tree;
  usual.binary_form = false;  // the tree that `render` makes
  const kdtree::BuildConfig config = prepare::config_of(usual, geometry.size());
  Forms forms;
  const std::uint64_t peak_before = peak_memory();  // measuring the next one makes the system forget it
  const std::optional<std::uint64_t> build_peak =
      peak_bytes_of([&] { forms = build_forms_within(scene, geometry, config, o.tree.memory_bytes); });

  Parts parts = parts_report(scene, o.json ? std::numeric_limits<std::size_t>::max() : kShown);
  Json report = scene_report(scene, geometry, std::move(parts.first));
  report["tree"] = tree_report(kdtree::measure(forms.tree, geometry, config));
  report["tree"]["build"] = prepare::name_of(o.tree.quality);
  report["memory"] = memory_report({scene, geometry, forms.tree, forms.flat, forms.wide, build_peak,
                                    std::max(peak_before, peak_memory())});
  report["seconds"] = {{"load", load_seconds},
                       {"build", geometry_seconds + forms.build_seconds},
                       {"flatten", forms.flatten_seconds}};
  print(o.json ? report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"
               : report_as_text(report, parts.count));
  return 0;
}

}  // namespace

Command add_info(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("info", "Show counts, bounds, materials, tree statistics and memory of a scene");
  const auto o = std::make_shared<InfoArgs>();
  add_scene_input(*app, o->scene, "The scene, as for render");
  app->add_flag("--json", o->json, "Print JSON");
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
