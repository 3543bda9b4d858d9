// What    The report of `kdray info` as text for people.
#include <fmt/format.h>

#include <algorithm>

#include "apps/cli/info_report.h"
#include "apps/cli/message.h"

namespace kdray::cli {

namespace {

constexpr std::size_t kMaterialsShown = 12;  // the rest is counted; --json has them all

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

// A colour, or one number where its channels are alike; empty for black.
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
  for (std::size_t i = 0; i < std::min(materials.size(), kMaterialsShown); ++i)
    text += line("", fmt::format("{}: {}", i, material_text(materials[i])));
  if (materials.size() > kMaterialsShown)
    text += line("", fmt::format("and {} more (--json shows all)", materials.size() - kMaterialsShown));
  return text;
}

std::string lights_text(const Json& lights) {
  std::string text = line("lights", fmt::format("{}", lights.size()));
  for (std::size_t i = 0; i < std::min(lights.size(), kMaterialsShown); ++i) {
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

}  // namespace

std::string report_as_text(const Json& r) {
  const Json& bounds = r["bounds"];
  std::string text = one_line(r["scene"].get<std::string>()) + "\n";
  text += line("primitives", primitives_text(r["primitives"]));
  text += line("bounds", bounds.is_null() ? "none: the scene is empty"
                                          : vector_text(bounds["min"]) + " to " + vector_text(bounds["max"]));
  text += line("camera", camera_text(r["camera"]));
  text += line("background", background_text(r["background"]));
  text += lights_text(r["lights"]) + materials_text(r["materials"]) + tree_text(r["tree"]) +
          memory_text(r["memory"]);
  text += line("time", fmt::format("load {}, build {}, flatten {}",
                                   seconds_in_words(r["seconds"]["load"].get<double>()),
                                   seconds_in_words(r["seconds"]["build"].get<double>()),
                                   seconds_in_words(r["seconds"]["flatten"].get<double>())));
  return text;
}

}  // namespace kdray::cli
