// What    NFF text as lines of words, for tests that look at what a generator wrote without kdray's own
//         reader.
#pragma once

#include <array>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"
#include "scene/generate/generate.h"

namespace kdray::test {

using Words = std::vector<std::string>;

// The lines without comments and empty ones.
inline std::vector<Words> nff_lines(std::string_view text) {
  std::vector<Words> lines;
  std::istringstream in{std::string(text)};
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    Words w;
    for (std::string word; words >> word;) w.push_back(word);
    if (!w.empty() && w[0][0] != '#') lines.push_back(std::move(w));
  }
  return lines;
}

inline std::string generated(std::string_view name, int size) {
  std::ostringstream out;
  generate::generate(name, size, out);
  return out.str();
}

inline dvec3 vec(const Words& w, std::size_t first) {
  return {std::stod(w[first]), std::stod(w[first + 1]), std::stod(w[first + 2])};
}

struct NffSphere {
  dvec3 center;
  double radius;
};
struct NffCone {
  dvec3 base, apex;
  double base_radius, apex_radius;
};
struct NffPolygon {
  std::vector<dvec3> vertices, normals;  // normals: patches only
};

struct Nff {
  std::vector<NffSphere> spheres;
  std::vector<NffCone> cones;
  std::vector<NffPolygon> polygons, patches;
  int lights = 0;
  std::map<std::string, int> surfaces;  // `f` lines by their text
};

inline Nff parse_nff(std::string_view text) {
  Nff nff;
  const auto lines = nff_lines(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Words& w = lines[i];
    if (w[0] == "s") nff.spheres.push_back({vec(w, 1), std::stod(w[4])});
    if (w[0] == "c") nff.cones.push_back({vec(w, 1), vec(w, 5), std::stod(w[4]), std::stod(w[8])});
    if (w[0] == "l") ++nff.lights;
    if (w[0] == "f") {
      std::string line;
      for (const std::string& word : w) line += word + ' ';
      ++nff.surfaces[line];
    }
    if (w[0] != "p" && w[0] != "pp") continue;
    NffPolygon& polygon = (w[0] == "p" ? nff.polygons : nff.patches).emplace_back();
    for (int n = std::stoi(w[1]); n > 0; --n) {
      const Words& vertex = lines.at(++i);
      polygon.vertices.push_back(vec(vertex, 0));
      if (w[0] == "pp") polygon.normals.push_back(vec(vertex, 3));
    }
  }
  return nff;
}

}  // namespace kdray::test
