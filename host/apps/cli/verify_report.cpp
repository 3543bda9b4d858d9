#include "apps/cli/verify_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "apps/cli/output.h"

namespace kdray::cli {

namespace {

using verify::Component;
using verify::Defect;
using verify::Findings;

constexpr std::size_t kShownFindings = 100;

// "1 edge", "2 edges"
std::string counted(std::uint64_t n, const char* what) {
  return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

class Words {
 public:
  void plain(const std::string& name, const std::string& text) { line("", name, text); }
  // [ok] where there is none.
  void note(std::uint64_t n, const std::string& name, const std::string& text) {
    n > 0 ? line("[note]", name, text) : line("[ok]", name, "none");
  }
  void defect(std::uint64_t n, const std::string& name, const std::string& of) {
    line(n > 0 ? "[bad]" : "[ok]", name, fmt::format("{} {}", n, of));
  }
  const std::string& text() const { return text_; }

 private:
  void line(const char* sign, const std::string& name, const std::string& text) {
    fmt::format_to(std::back_inserter(text_), "{:<7}{:<18}{}\n", sign, name, text);
  }
  std::string text_;
};

struct Kinds {
  std::size_t watertight, closed, inside_out, one_sided;
};

Kinds kinds_of(const Findings& f) {
  const verify::Topology& t = f.topology;
  return {t.count([](const Component& c) { return c.watertight; }),
          t.count([](const Component& c) { return c.closed(); }),
          t.count([](const Component& c) { return c.closed() && c.volume < 0; }),
          t.count([](const Component& c) { return c.one_sided; })};
}

void tell_mesh(const Findings& f, Words& words) {
  const verify::Topology& t = f.topology;
  const Kinds kinds = kinds_of(f);
  words.plain("components", fmt::format("{}, {} of them watertight{}", t.components.size(), kinds.watertight,
                                        kinds.inside_out > 0
                                            ? fmt::format(", {} inside out (or a hollow)", kinds.inside_out)
                                            : std::string()));
  words.note(t.open.size(), "open edges",
             fmt::format("{}, in {}: rims of holes, outlines, or seams whose corners are not in one place",
                         t.open.size(), counted(t.loops, "piece")));
  words.note(t.crowded.size(), "crowded edges", fmt::format("{} of three or more faces", t.crowded.size()));
  words.note(
      t.turned.size(), "flipped faces",
      fmt::format("{}, by {} whose two faces disagree about the front{}: it matters where the material is "
                  "transparent",
                  t.flipped.size(), counted(t.turned.size(), "edge"),
                  kinds.one_sided > 0 ? fmt::format("; {} with one side only (as a Moebius strip)",
                                                    counted(kinds.one_sided, "component"))
                                      : std::string()));
  words.note(
      f.duplicates.doubled.size(), "doubled faces",
      fmt::format("{} whose three corners another face has too: which one is seen is decided by a rounding",
                  f.duplicates.doubled.size()));
  words.note(
      f.duplicates.overlapping.size(), "overlapping faces",
      fmt::format("{} in one plane with common ground: which one is seen there is decided by a rounding",
                  counted(f.duplicates.overlapping.size(), "pair")));
}

struct DefectName {
  Defect defect;
  const char* name;  // in the report
  const char* key;   // in JSON
};
constexpr DefectName kDefectNames[verify::kDefects] = {
    {Defect::leak, "leaks", "leaks"},
    {Defect::lost_hit, "lost hits", "lost_hits"},
    {Defect::self_hit, "self-hits", "self_hits"},
    {Defect::behind, "hits behind", "hits_behind"},
    {Defect::disagreement, "walks that differ", "disagreements"},
    {Defect::not_a_number, "NaN", "nan"},
};

std::uint64_t count_of(const Findings& f, Defect defect) {
  return f.probes.count[static_cast<std::size_t>(defect)];
}

std::string rays_of(const Findings& f, Defect defect) {
  const verify::Probes& p = f.probes;
  switch (defect) {
    case Defect::leak: {
      if (p.from_inside == 0)
        return "- nothing is watertight (and large enough), so nothing has an inside to leak from";
      std::string text =
          fmt::format("of {} rays from {} inside of {}", in_words(static_cast<double>(p.from_inside)),
                      counted(p.origins, "place"), counted(p.components, "component"));
      if (p.in_doubt > 0) text += fmt::format("; {} too near a surface to tell", p.in_doubt);
      return text;
    }
    case Defect::lost_hit:
      return fmt::format("of {} rays aimed at chosen places", in_words(static_cast<double>(p.from_outside)));
    case Defect::self_hit:
      return fmt::format("of {} rays that leave a hit", in_words(static_cast<double>(p.leaving)));
    case Defect::behind:
      return fmt::format("of {} rays, behind their origin", in_words(static_cast<double>(p.rays())));
    case Defect::disagreement:
      return "hits of wide, packet, batch and auto that are not the binary tree's, bit for bit";
    default:
      return "in hits and in the origins of rays that leave them";
  }
}

void tell_tracing(const Findings& f, Words& words) {
  for (const DefectName& d : kDefectNames) words.defect(count_of(f, d.defect), d.name, rays_of(f, d.defect));
  words.defect(f.film.not_finite + !f.film.fault.empty(), "film",
               f.film.fault.empty() ? fmt::format("of {} pixels not finite", f.film.pixels)
                                    : "fault: " + one_line(f.film.fault));
  words.note(
      f.probes.crossed_twice, "double hits",
      fmt::format(
          "{} rays met a closed component's surface twice in one place, at an edge: a transparent one bends "
          "them twice",
          f.probes.crossed_twice));
}

Json place(const Findings& f, const vec3& p) {
  const dvec3 world = f.space.world(dvec3(p));
  return {world.x, world.y, world.z};
}

Json edges_json(const Findings& f, const std::vector<verify::Edge>& edges) {
  Json json = {{"count", edges.size()}, {"some", Json::array()}};
  for (std::size_t i = 0; i < std::min(edges.size(), kShownFindings); ++i)
    json["some"].push_back({{"from", place(f, f.mesh.points[edges[i].a])},
                            {"to", place(f, f.mesh.points[edges[i].b])},
                            {"primitive", f.mesh.numbers[edges[i].triangle]}});
  return json;
}

Json faces_json(const Findings& f, const std::vector<std::uint32_t>& faces) {
  Json json = {{"count", faces.size()}, {"some", Json::array()}};
  for (std::size_t i = 0; i < std::min(faces.size(), kShownFindings); ++i)
    json["some"].push_back(f.mesh.numbers[faces[i]]);
  return json;
}

double world_volume(const Findings& f, double local) {
  for (int k = 0; k < 3; ++k) local = f.space.world_length(local);
  return local;
}

Json components_json(const Findings& f) {
  Json json = Json::array();
  for (std::size_t i = 0; i < std::min(f.topology.components.size(), kShownFindings); ++i) {
    const Component& c = f.topology.components[i];
    json.push_back({{"faces", c.faces},
                    {"first_primitive", f.mesh.numbers[c.first]},
                    {"watertight", c.watertight},
                    {"closed", c.closed()},
                    {"one_sided", c.one_sided},
                    {"open_edges", c.open_edges},
                    {"crowded_edges", c.crowded_edges},
                    {"flipped_faces", c.flipped},
                    {"volume", c.closed() ? Json(world_volume(f, c.volume)) : Json()}});
  }
  return json;
}

Json mesh_json(const Findings& f) {
  const Kinds kinds = kinds_of(f);
  Json json = {{"sound", f.mesh_is_sound()},
               {"points", f.mesh.points.size()},
               {"edges", f.topology.n_edges},
               {"stitches", f.counts.zero_area},
               {"dropped_degenerate", f.dropped},
               {"open_edges", edges_json(f, f.topology.open)},
               {"open_pieces", f.topology.loops},
               {"crowded_edges", edges_json(f, f.topology.crowded)},
               {"turned_edges", edges_json(f, f.topology.turned)},
               {"flipped_faces", faces_json(f, f.topology.flipped)},
               {"doubled_faces", faces_json(f, f.duplicates.doubled)},
               {"overlapping_pairs", {{"count", f.duplicates.overlapping.size()}, {"some", Json::array()}}},
               {"components",
                {{"count", f.topology.components.size()},
                 {"watertight", kinds.watertight},
                 {"closed", kinds.closed},
                 {"inside_out", kinds.inside_out},
                 {"one_sided", kinds.one_sided},
                 {"largest", components_json(f)}}}};
  Json& pairs = json["overlapping_pairs"]["some"];
  for (std::size_t i = 0; i < std::min(f.duplicates.overlapping.size(), kShownFindings); ++i) {
    const auto& [a, b] = f.duplicates.overlapping[i];
    pairs.push_back({f.mesh.numbers[a], f.mesh.numbers[b]});
  }
  return json;
}

Json tracing_json(const Findings& f) {
  const verify::Probes& p = f.probes;
  Json json = {{"sound", f.kdray_is_sound()},
               {"rays_from_inside", p.from_inside},
               {"rays_from_outside", p.from_outside},
               {"rays_leaving_hits", p.leaving},
               {"origins_inside", p.origins},
               {"components_inside", p.components},
               {"in_doubt", p.in_doubt},
               {"crossed_twice", p.crossed_twice},
               {"film_pixels", f.film.pixels},
               {"film_not_finite", f.film.not_finite},
               {"film_fault", f.film.fault}};
  for (const DefectName& d : kDefectNames) json[d.key] = count_of(f, d.defect);
  Json& witnesses = json["witnesses"] = Json::array();
  for (const verify::Witness& w : p.witnesses) {
    const vec3 o(w.ray.origin[0], w.ray.origin[1], w.ray.origin[2]);
    witnesses.push_back({{"what", kDefectNames[static_cast<std::size_t>(w.defect)].key},
                         {"where", place(f, w.where)},
                         {"primitive", w.primitive},
                         {"origin", place(f, o)},
                         {"direction", {w.ray.direction[0], w.ray.direction[1], w.ray.direction[2]}}});
  }
  return json;
}

std::string counted(const Findings& f) {
  return primitives::counts_in_words([&](auto kind) { return decltype(kind)::of(f.counts); });
}

}  // namespace

std::string findings_in_words(const Findings& f) {
  Words words;
  words.plain("scene",
              fmt::format("{}; {} points, {} edges", counted(f), f.mesh.points.size(), f.topology.n_edges));
  if (f.counts.triangles > 0) tell_mesh(f, words);
  if (f.counts.zero_area > 0)
    words.plain("stitches",
                fmt::format("{} without area, of three corners on a line: they close gaps at corners that "
                            "lie on other faces' edges",
                            counted(f.counts.zero_area, "triangle")));
  words.note(f.dropped, "degenerate",
             fmt::format("{} with corners in one place, which no ray can hit", f.dropped));
  if (f.probes.rays() > 0) tell_tracing(f, words);
  return words.text();
}

std::string verdict(const Findings& f) {
  if (!f.kdray_is_sound())
    return fmt::format(
        "kdray itself is at fault: {} of {} rays went wrong{}; please report it with the scene",
        f.probes.defects(), f.probes.rays(),
        f.film.fault.empty() && f.film.not_finite == 0 ? "" : ", and a picture's values");
  if (counted(f) == "nothing") return "there is nothing to hit in this scene";
  return fmt::format("kdray traces this scene soundly, {}", f.counts.triangles == 0 ? "and it has no mesh"
                                                            : f.mesh_is_sound()
                                                                ? "and its mesh is sound"
                                                                : "but see the notes on its mesh");
}

Json findings_as_json(const Findings& f) {
  return {{"verdict", verdict(f)}, {"mesh", mesh_json(f)}, {"tracing", tracing_json(f)}};
}

}  // namespace kdray::cli
