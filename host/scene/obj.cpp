// What    Wavefront OBJ: vertices, normals, polygons, and the materials of its MTL files. Groups and texture
//         coordinates mean nothing to a Whitted ray tracer and are skipped; vertex colours, points, lines and
//         free-form surfaces are left out with a warning.
// Shape   Materials are looked up after the last line, so `mtllib` may stand anywhere.
// Errors  File and line of the word at fault. A normal that doesn't exist makes its face flat (a warning); a
//         vertex that doesn't exist refuses the file.
// Source  Alias Wavefront, "Object files", Appendix B1 of the Advanced Visualizer manual. Numbers are read
//         exactly rounded, which the usual OBJ libraries don't do.
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "scene/add_polygon.h"
#include "scene/importers.h"
#include "scene/line_scanner.h"
#include "scene/obj_materials.h"
#include "scene/plain_number.h"
#include "scene/reserve_ahead.h"
#include "scene/settle_normals.h"
#include "scene/text_scanner.h"

namespace kdray::scene {

namespace {

// Something left out: how often, and where first.
struct LeftOut {
  std::size_t count = 0;
  std::uint32_t line = 0;
  void add(std::uint32_t at) {
    if (count++ == 0) line = at;
  }
};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::filesystem::path& file)
      : in_(text, file.string()), materials_(file, scene_) {}

  Scene read() {
    while (in_.next_line()) {
      const std::string_view keyword = in_.word();
      if (keyword.empty()) continue;
      ++n_statements_;
      read_statement(keyword);
    }
    if (n_statements_ > 0 && unknown_.count == n_statements_) {
      throw input_error(in_.file(), unknown_.line, "not an OBJ file: no line of it is an OBJ statement");
    }
    materials_.finish();
    settle_normals(scene_, in_.file());
    warn_of_what_is_left_out();
    return std::move(scene_);
  }

 private:
  void read_statement(std::string_view keyword) {
    if (keyword == "v") return read_vertex();
    if (keyword == "vn") return read_normal();
    if (keyword == "f" || keyword == "fo") return read_face();
    if (keyword == "usemtl") return materials_.use(in_.rest());
    if (keyword == "mtllib") return materials_.add_library(in_.rest(), in_.line());
    if (keyword == "p" || keyword == "l") return points_and_lines_.add(in_.line());
    if (keyword == "curv" || keyword == "curv2" || keyword == "surf") return free_forms_.add(in_.line());
    if (means_nothing_here(keyword)) return;
    unknown_.add(in_.line());
  }

  static bool means_nothing_here(std::string_view keyword) {
    constexpr std::string_view kSkipped[] = {
        "vt",        "vp",    "vw",    "g",    "s",      "mg",     "o",      "bevel", "c_interp",
        "d_interp",  "lod",   "call",  "csh",  "usemap", "maplib", "cstype", "deg",   "bmat",
        "step",      "parm",  "trim",  "hole", "scrv",   "sp",     "end",    "con",   "t",
        "trace_obj", "ctech", "stech", "res",  "bzp",    "bsp",    "cdc",    "cdp",   "shadow_obj"};
    for (const std::string_view skipped : kSkipped) {
      if (keyword == skipped) return true;
    }
    return false;
  }

  dvec3 three_numbers(std::string_view what) {
    const double x = in_.number(what);
    const double y = in_.number(what);
    const double z = in_.number(what);
    return {x, y, z};
  }

  void read_vertex() {
    vertex_reserve_.reserve(scene_.vertices, in_.bytes_left());
    scene_.vertices.push_back(three_numbers("a vertex of three numbers"));
    if (!in_.word().empty() && !in_.word().empty()) colored_vertices_.add(in_.line());  // more than a weight
  }

  void read_normal() {
    normal_reserve_.reserve(scene_.normals, in_.bytes_left());
    scene_.normals.push_back(direction_of(three_numbers("a normal of three numbers")));
  }

  // Reads one corner: v, v/vt, v//vn or v/vt/vn. Returns false at the end of the line.
  bool read_corner() {
    std::int64_t value = 0;
    if (const std::string_view plain = in_.plain_whole(value); !plain.empty()) {
      corners_.push_back(vertex_number(value, plain));
      normals_.push_back(kNone);
      return true;
    }
    const std::string_view word = in_.word();
    if (word.empty()) return false;
    const std::size_t first = word.find('/');
    corners_.push_back(vertex_number(whole_number(word.substr(0, first), word), word));
    std::uint32_t normal = kNone;
    if (first != std::string_view::npos) {
      const std::size_t second = word.find('/', first + 1);
      if (second != std::string_view::npos && second + 1 < word.size()) {
        normal = normal_number(word.substr(second + 1), word);
      }
    }
    normals_.push_back(normal);
    return true;
  }

  std::int64_t whole_number(std::string_view digits, std::string_view word) const {
    std::int64_t value = 0;
    const char* const end = digits.data() + digits.size();
    if (read_plain_whole(digits.data(), end, value) == end) return value;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [stop, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (code != std::errc() || stop != end || digits.empty()) {
      throw in_.error("expected a corner like 7, 7/2, 7//3 or 7/2/3, found '" + printable(word) + "'");
    }
    return value;
  }

  std::uint32_t vertex_number(std::int64_t value, std::string_view word) const {
    const auto n = static_cast<std::int64_t>(scene_.vertices.size());
    const std::int64_t index = value < 0 ? n + value : value - 1;
    if (value == 0)
      throw in_.error("there is no vertex 0 in '" + printable(word) + "'", "vertices count from 1");
    if (index < 0 || index >= n) {
      throw in_.error("there is no vertex " + std::to_string(value) + " before this line (there are " +
                      std::to_string(n) + ")");
    }
    return static_cast<std::uint32_t>(index);
  }

  std::uint32_t normal_number(std::string_view digits, std::string_view word) {
    const std::int64_t value = whole_number(digits, word);
    const auto n = static_cast<std::int64_t>(scene_.normals.size());
    const std::int64_t index = value < 0 ? n + value : value - 1;
    if (value != 0 && index >= 0 && index < n) return static_cast<std::uint32_t>(index);
    missing_normals_.add(in_.line());
    return kNone;
  }

  void read_face() {
    corners_.clear();
    normals_.clear();
    while (read_corner()) {
    }
    if (corners_.size() < 3) return small_faces_.add(in_.line());
    bool smooth = true;
    for (const std::uint32_t n : normals_) smooth = smooth && n != kNone;
    if (!smooth) normals_.clear();
    triangle_reserve_.reserve(scene_.triangles, in_.bytes_left());
    add_polygon(scene_, corners_, normals_, materials_.current());
  }

  void warn(const LeftOut& what, const std::string& text) {
    if (what.count == 0) return;
    scene_.warnings.push_back(in_.file() + ":" + std::to_string(what.line) + ": " +
                              std::to_string(what.count) + " " + text + " (the first is in this line)");
  }
  void warn_of_what_is_left_out() {
    warn(small_faces_, "faces with fewer than 3 corners are left out");
    warn(missing_normals_, "corners name a normal that does not exist: those faces are shaded flat");
    warn(points_and_lines_, "points and lines are left out: they have no surface");
    warn(colored_vertices_, "vertices have colours, which are left out: a material holds for a whole face");
    warn(free_forms_, "free-form curves and surfaces are left out: only polygons are read");
    warn(unknown_, "lines that are no OBJ statements are left out");
    if (scene_.triangles.empty()) scene_.warnings.push_back(in_.file() + ": no faces");
  }

  LineScanner in_;
  Scene scene_;
  ObjMaterials materials_;
  ReserveAhead vertex_reserve_, normal_reserve_, triangle_reserve_;
  std::vector<std::uint32_t> corners_, normals_;
  LeftOut small_faces_, missing_normals_, points_and_lines_, free_forms_, unknown_, colored_vertices_;
  std::size_t n_statements_ = 0;
};

}  // namespace

Scene read_obj(std::string_view text, const std::filesystem::path& file) {
  return ObjReader(text, file).read();
}

}  // namespace kdray::scene
