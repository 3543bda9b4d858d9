// What    Wavefront OBJ: vertices with colours, normals, texture coordinates, polygons, and the materials of
//         its MTL files. Groups mean nothing to a Whitted ray tracer and are skipped; points, lines and
//         free-form surfaces are left out with a warning.
// Shape   Materials are looked up after the last line, so `mtllib` may stand anywhere. Texture coordinates
//         are read where the file has MTL files, and kept where one of those names a picture. A file whose
//         faces come before their vertices is read twice: its points, then the rest.
// Errors  File and line of the word at fault. A normal that doesn't exist makes its face flat (a warning); a
//         vertex that doesn't exist refuses the file: others may then be another's, too.
// Source  Alias Wavefront, "Object files", Appendix B1 of the Advanced Visualizer manual. Numbers are read
//         exactly rounded, which the usual OBJ libraries don't do.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/load.h"
#include "scene/import/obj/mtl.h"
#include "scene/import/text_scanner.h"
#include "scene/model/normals.h"
#include "scene/model/polygon.h"

namespace kdray::scene {

namespace {

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::filesystem::path& file)
      : text_(text), in_(text, file.string()), materials_(file, scene_) {
    reads_texcoords_ = keeps_texcoords() || text.find("tllib") != std::string_view::npos ||
                       text.find("TLLIB") != std::string_view::npos;
  }

  // Returns nothing where a face names what comes only after it.
  std::optional<Scene> read_in_order() {
    read_lines();
    return looks_ahead_ ? std::nullopt : std::optional(finish());
  }

  Scene read_points_first() {
    pass_ = Pass::points;
    read_lines();
    pass_ = Pass::rest;
    n_vertices_ = n_normals_ = n_texcoords_ = 0;
    in_ = LineScanner(text_, in_.file());
    read_lines();
    return finish();
  }

 private:
  enum class Pass { all, points, rest };

  void read_lines() {
    std::string spelled;
    while (!looks_ahead_ && in_.next_line()) {
      std::string_view keyword = in_.word();
      if (std::ranges::any_of(keyword, [](char c) { return c != lower(c); }))
        keyword = spelled = lower(keyword);
      if (keyword.empty() || read_point(keyword) || pass_ == Pass::points) continue;
      ++n_statements_;
      if (!read_statement(keyword)) left_out_.add(kNoStatement, in_.line());
    }
  }

  Scene finish() {
    if (n_statements_ > 0 && scene_.vertices.empty() && left_out_.count(kNoStatement) == n_statements_)
      throw input_error(in_.file(), 0, "not an OBJ file: no line of it is an OBJ statement");
    color_corners();
    materials_.finish(!scene_.texturing.colors.empty(), names_);
    scene_.names = names_.finish(scene_.primitive_count(), 0);
    if (scene_.texturing.textures.empty() && !keeps_texcoords()) scene_.texturing.texcoords[0] = {};
    settle_vertices(scene_, [&](std::size_t) { return in_.file() + ":" + std::to_string(bad_vertex_line_); });
    settle_normals(scene_, in_.file());
    left_out_.warn(in_.file(), scene_.warnings);
    return std::move(scene_);
  }

  // Of points alone, which the second pass counts.
  bool read_point(std::string_view keyword) {
    const bool known = keyword == "v" || keyword == "vn" || keyword == "vt";
    if (!known) return false;
    if (keyword == "v") {
      ++n_vertices_;
      if (pass_ != Pass::rest) read_vertex();
    } else if (keyword == "vn") {
      ++n_normals_;
      if (pass_ != Pass::rest) read_normal();
    } else if (reads_texcoords_) {
      ++n_texcoords_;
      if (pass_ != Pass::rest) read_texcoords();
    }
    return true;
  }

  bool read_statement(std::string_view keyword) {
    if (keyword == "f" || keyword == "fo") {
      read_face();
    } else if (keyword == "usemtl") {
      materials_.use(unquoted(in_.rest()));
    } else if (keyword == "o" || (keyword == "g" && !has_objects_)) {
      has_objects_ = keyword == "o";
      part_ = in_.rest();
      is_new_part_ = true;
    } else if (keyword == "mtllib") {
      materials_.add_library(in_.rest(), in_.line());
    } else if (keyword == "p" || keyword == "l") {
      left_out_.add("points and lines are left out: they have no surface", in_.line());
    } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf") {
      left_out_.add("free-form curves and surfaces are left out: only polygons are read", in_.line());
    } else {
      return means_nothing_here(keyword);
    }
    return true;
  }

  static bool means_nothing_here(std::string_view keyword) {
    constexpr std::string_view kSkipped[] = {
        "vp",    "vw",    "g",    "s",      "mg",     "o",      "bevel", "c_interp",  "d_interp",
        "lod",   "call",  "csh",  "usemap", "maplib", "cstype", "deg",   "bmat",      "step",
        "parm",  "trim",  "hole", "scrv",   "sp",     "end",    "con",   "t",         "trace_obj",
        "ctech", "stech", "res",  "bzp",    "bsp",    "cdc",    "cdp",   "shadow_obj"};
    for (const std::string_view skipped : kSkipped) {
      if (keyword == skipped) return true;
    }
    return false;
  }

  dvec3 three_numbers(std::string_view what) {
    const double x = in_.number(what, NotFinite::nan);
    const double y = in_.number(what, NotFinite::nan);
    const double z = in_.number(what, NotFinite::nan);
    return {x, y, z};
  }

  void read_vertex() {
    vertex_reserve_.reserve(scene_.vertices, in_.bytes_left());
    scene_.vertices.push_back(three_numbers("a vertex of three numbers"));
    if (bad_vertex_line_ == 0 && !is_finite(scene_.vertices.back())) bad_vertex_line_ = in_.line();
    read_color();
  }

  // One more number is a weight, three are a colour, four a weight and a colour.
  void read_color() {
    std::array<float, 4> numbers{};
    std::size_t n = 0;
    for (double value = 0; n < 4; ++n) {
      const std::string_view word = in_.word();
      if (word.empty()) break;
      if (!read_number(word.data(), word.data() + word.size(), value))
        return left_out_.add("vertices have no finite numbers after their position: these are left out",
                             in_.line());
      numbers[n] = static_cast<float>(std::clamp(value, 0.0, 255.0));
    }
    if (n == 2)
      left_out_.add("vertices have two numbers after their position, which are left out", in_.line());
    if (n < 3) return;
    const std::array<float, 3> color{numbers[n - 3], numbers[n - 2], numbers[n - 1]};
    colors_.resize(scene_.vertices.size() - 1, {1, 1, 1});  // those of vertices that have none
    colors_.push_back(color);
  }

  // Codes of sRGB, from 0 to 1; in files that have larger ones, to 255.
  void color_corners() {
    if (colors_.empty()) return;
    colors_.resize(scene_.vertices.size(), {1, 1, 1});
    float most = 1;
    for (const auto& color : colors_) most = std::max({most, color[0], color[1], color[2]});
    const double scale = most > 1 ? 1 / 255.0 : 1;
    RawVector<std::array<std::uint32_t, 4>> linear(colors_.size());
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) linear[i][c] = linear_unit_of_srgb(colors_[i][c] * scale);
      linear[i][3] = 65535;
    }
    scene_.texturing.colors.resize(scene_.triangles.size());
    for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        set_corner(scene_.texturing.colors[i], k, linear[scene_.triangles[i].vertex[k]]);
  }

  // v goes upwards in the file, downwards in textures.
  void read_texcoords() {
    double u = 0, v = 0;
    u = in_.number("a texture coordinate", NotFinite::nan);
    in_.try_number("a texture coordinate", v, NotFinite::nan);
    if (!std::isfinite(u + v)) {
      u = v = 0;
      left_out_.add("texture coordinates are not finite: they are taken for 0", in_.line());
    }
    const auto narrow = [](double value) { return static_cast<float>(std::clamp(value, -1e6, 1e6)); };
    texcoord_reserve_.reserve(texcoords_, in_.bytes_left());
    texcoords_.push_back({narrow(u), narrow(1 - v)});
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
      corner_texcoords_.push_back(kNoTexcoord);
      return true;
    }
    const std::string_view word = in_.word();
    if (word.empty()) return false;
    const std::size_t first = word.find('/');
    corners_.push_back(vertex_number(whole_number(word.substr(0, first), word), word));
    std::uint32_t normal = kNone;
    corner_texcoords_.push_back(reads_texcoords_ ? texcoord_of(word, first) : kNoTexcoord);
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

  // Returns the place in an array of `n` entries, `before` of them before this line. Returns nothing where
  // there is none, or where it comes later; the file then has to be read another way.
  std::optional<std::size_t> place_of(std::int64_t value, std::size_t before, std::size_t n) {
    const auto counted = static_cast<std::int64_t>(before);
    const std::int64_t index = value < 0 ? counted + value : value - 1;
    if (value > counted && pass_ == Pass::all) looks_ahead_ = true;
    if (value == 0 || index < 0 || static_cast<std::size_t>(index) >= n) return std::nullopt;
    return static_cast<std::size_t>(index);
  }

  std::uint32_t vertex_number(std::int64_t value, std::string_view word) {
    const auto place = place_of(value, n_vertices_, scene_.vertices.size());
    if (place) return static_cast<std::uint32_t>(*place);
    if (looks_ahead_) return 0;
    if (value == 0)
      throw in_.error("there is no vertex 0 in '" + printable(word) + "'", "vertices count from 1");
    throw in_.error("there is no vertex " + std::to_string(value) + " (the file has " +
                    std::to_string(scene_.vertices.size()) +
                    (value < 0 ? ", of which " + std::to_string(n_vertices_) + " before this line)" : ")"));
  }

  std::uint32_t normal_number(std::string_view digits, std::string_view word) {
    const auto place = place_of(whole_number(digits, word), n_normals_, scene_.normals.size());
    if (place) return static_cast<std::uint32_t>(*place);
    if (!looks_ahead_)
      left_out_.add("corners name a normal that does not exist: those faces are shaded flat", in_.line());
    return kNone;
  }

  // Returns the texture coordinates of v/vt, v/vt/vn or v//vn, whose first slash is at `first`.
  std::array<float, 2> texcoord_of(std::string_view word, std::size_t first) {
    if (first == std::string_view::npos || first + 1 >= word.size() || word[first + 1] == '/')
      return kNoTexcoord;
    const std::size_t end = std::min(word.find('/', first + 1), word.size());
    const std::int64_t value = whole_number(word.substr(first + 1, end - first - 1), word);
    has_texcoords_ = true;
    if (const auto place = place_of(value, n_texcoords_, texcoords_.size())) return texcoords_[*place];
    if (!looks_ahead_)
      left_out_.add("corners name a texture coordinate that does not exist: it is taken for 0", in_.line());
    return kNoTexcoord;
  }

  void read_face() {
    corners_.clear();
    normals_.clear();
    corner_texcoords_.clear();
    has_texcoords_ = false;
    while (read_corner()) {
    }
    if (looks_ahead_) return;
    if (corners_.size() < 3) return left_out_.add("faces with fewer than 3 corners are left out", in_.line());
    bool smooth = true;
    for (const std::uint32_t n : normals_) smooth = smooth && n != kNone;
    if (!smooth) normals_.clear();
    triangle_reserve_.reserve(scene_.triangles, in_.bytes_left());
    if (!has_texcoords_) corner_texcoords_.clear();
    if (is_new_part_) names_.name_primitives(scene_.primitive_count(), names_.add(part_));
    is_new_part_ = false;
    if (!add_polygon(scene_, corners_, normals_, materials_.current(), corner_texcoords_))
      scene_.warnings.push_back(in_.error(polygon_warning(corners_.size())).what());
  }

  static constexpr std::string_view kNoStatement = "lines that are no OBJ statements are left out";

  std::string_view text_;
  LineScanner in_;
  Scene scene_;
  ObjMaterials materials_;
  NameTable names_;
  std::string
      part_;  // the name of the faces that follow: an object's, or a group's where there are no objects
  bool has_objects_ = false, is_new_part_ = false;
  static constexpr std::array<float, 2> kNoTexcoord{0, 0};

  bool reads_texcoords_;
  ReserveAhead vertex_reserve_, normal_reserve_, texcoord_reserve_, triangle_reserve_;
  std::vector<std::uint32_t> corners_, normals_;
  std::vector<std::array<float, 2>> corner_texcoords_;
  bool has_texcoords_ = false;  // of the face in work
  RawVector<std::array<float, 2>> texcoords_;
  std::vector<std::array<float, 3>> colors_;  // of the first vertices, as they stand in the file
  LeftOut left_out_;
  std::uint32_t bad_vertex_line_ = 0;  // the first that is not finite
  std::size_t n_statements_ = 0;       // other than points
  Pass pass_ = Pass::all;
  bool looks_ahead_ = false;
  std::size_t n_vertices_ = 0, n_normals_ = 0, n_texcoords_ = 0;  // before this line
};

}  // namespace

Scene read_obj(std::string_view text, const std::filesystem::path& file) {
  if (auto scene = ObjReader(text, file).read_in_order()) return std::move(*scene);
  return ObjReader(text, file).read_points_first();
}

}  // namespace kdray::scene
