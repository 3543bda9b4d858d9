// What    STL, ascii and binary. Facets are flat: the normals in the file are ignored (many files have them
//         wrong). Binary files may have colours by VisCAM's and Materialise's conventions.
// Shape   A binary file is recognised by its size, which follows exactly from its facet count: many binary
//         files begin with the word "solid", too.
// Source  Materialise: "COLOR=" in the header and four bytes, red, green, blue and alpha, of facets whose
//         highest attribute bit is set; the others have their own, red in the lowest five bits. VisCAM: the
//         highest bit says that the facet has a colour, blue in the lowest bits.
// Errors  ascii: file and line; binary: file and facet.
#include <array>
#include <bit>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/import/load.h"
#include "scene/import/materials.h"
#include "scene/import/text_scanner.h"
#include "scene/model/normals.h"
#include "scene/model/polygon.h"

namespace kdray::scene {

namespace {

constexpr std::size_t kHeaderBytes = 84;  // 80 of text, the count
constexpr std::size_t kFacetBytes = 50;   // normal, three vertices, attribute

std::uint32_t load_u32(const char* bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return value;
}
float load_f32(const char* bytes) {
  return std::bit_cast<float>(load_u32(bytes));
}

std::size_t size_of_facets(std::size_t n) {
  return kHeaderBytes + kFacetBytes * n;
}
std::size_t facet_count(std::string_view text) {
  return load_u32(text.data() + kHeaderBytes - 4);
}

bool looks_like_text(std::string_view text) {
  const std::string_view start = text.substr(0, 1024);
  std::size_t first = start.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  while (first != std::string_view::npos && start[first] == '#')  // a comment
    first = start.find_first_not_of(" \t\r\n", start.find_first_of("\r\n", first));
  return first != std::string_view::npos && same_word(start.substr(first, 5), "solid") &&
         start.find('\0') == std::string_view::npos;
}

class AsciiReader {
 public:
  AsciiReader(std::string_view text, const std::string& file) : in_(text, file) {}

  Scene read() {
    in_.at_end();
    take("solid");
    begin_solid();
    while (!in_.at_end()) {
      if (is_next("facet")) {
        read_facet();
      } else if (try_take_end("solid")) {
        read_name();
      } else if (try_take("solid")) {
        begin_solid();
      } else {
        throw in_.expected("facet or endsolid");
      }
    }
    left_out_.warn(in_.file(), scene_.warnings);
    scene_.names = names_.finish(scene_.primitive_count(), 0);
    return std::move(scene_);
  }

 private:
  bool is_next(std::string_view wanted) { return same_word(in_.peek(), wanted); }
  bool try_take(std::string_view wanted) {
    const bool found = is_next(wanted);
    if (found) in_.word(wanted);
    return found;
  }
  void take(std::string_view wanted) {
    if (!try_take(wanted)) throw in_.expected("'" + std::string(wanted) + "'");
  }

  // "endloop", or "end loop".
  bool try_take_end(const std::string& what) {
    if (try_take("end" + what)) return true;
    TextScanner ahead = in_;
    if (!same_word(ahead.peek(), "end")) return false;
    ahead.word("end");
    if (!same_word(ahead.peek(), what)) return false;
    ahead.word(what);
    in_ = ahead;
    return true;
  }

  // One that is missing is made up where it could only stand here.
  void take_end(const std::string& what) {
    if (try_take_end(what)) return;
    const bool ends_here = in_.at_end() || same_word(in_.peek().substr(0, 3), "end") || is_next("facet");
    if (!ends_here) throw in_.expected("'end" + what + "'");
    left_out_.add("statements 'end" + what + "' are missing before what follows: they are taken as said",
                  in_.line());
  }

  void begin_solid() { names_.name_primitives(scene_.primitive_count(), names_.add(read_name())); }

  // Returns a solid's name: whatever is left of the line, or, in a file that is one line, up to what can't be
  // a name.
  std::string read_name() {
    const std::uint32_t line = in_.line();
    std::string name;
    while (!in_.at_end() && in_.line() == line && !begins_statement())
      name.append(name.empty() ? "" : " ").append(in_.word("a name"));
    return name;
  }

  // "endsolid", or "facet normal X Y Z outer" on this line: a name may have the first words of that, too.
  bool begins_statement() {
    if (is_next("endsolid")) return true;
    if (!is_next("facet")) return false;
    TextScanner ahead = in_;
    constexpr int kWords = 6;
    for (int i = 0; i < kWords && !ahead.at_end() && ahead.line() == in_.line(); ++i) {
      if (i == 1 && !same_word(ahead.peek(), "normal")) return false;
      if (same_word(ahead.word("a name"), "outer")) return true;
    }
    return false;
  }

  void read_facet() {
    take("facet");
    take("normal");
    // The numbers of a normal may be anything, even "1.#IND".
    const std::uint32_t line = in_.line();
    while (!in_.at_end() && in_.line() == line && !is_next("outer")) in_.word("a normal");
    take("outer");
    take("loop");
    corners_.clear();
    bool finite = true;
    while (try_take("vertex")) {
      corners_.push_back(static_cast<std::uint32_t>(scene_.vertices.size()));
      scene_.vertices.push_back(in_.vector("a vertex of three numbers", NotFinite::nan));
      finite = finite && is_finite(scene_.vertices.back());
    }
    if (corners_.size() < 3) throw in_.expected("three lines 'vertex X Y Z'");
    if (finite) {
      if (!add_polygon(scene_, corners_, {}, 0))
        scene_.warnings.push_back(input_error(in_.file(), line, polygon_warning(corners_.size())).what());
    } else {
      scene_.vertices.resize(corners_[0]);
      left_out_.add("facets have a coordinate that is not finite: they are left out", line);
    }
    take_end("loop");
    take_end("facet");
  }

  TextScanner in_;
  Scene scene_;
  NameTable names_;
  LeftOut left_out_;
  std::vector<std::uint32_t> corners_;
};

// The colours of facets, whose attributes are 15 bits of colour under one that says what they are.
class FacetColors {
 public:
  FacetColors(std::string_view text, std::size_t n) : text_(text), n_(n) {
    constexpr std::string_view kMark = "COLOR=";
    const std::size_t mark = text.substr(0, kHeaderBytes - 8).find(kMark);
    if (mark != std::string_view::npos) {
      const char* const of_all = text.data() + mark + kMark.size();
      of_all_ = {code(of_all[0]), code(of_all[1]), code(of_all[2])};
    }
  }

  bool any() const {
    for (std::size_t i = 0; i < n_ && !of_all_; ++i)
      if (attribute(i) & kMarked) return true;
    return of_all_.has_value();
  }

  std::array<std::uint32_t, 4> of(std::size_t facet) const {
    const std::uint32_t bits = attribute(facet);
    const bool own = ((bits & kMarked) != 0) != of_all_.has_value();
    const std::uint32_t low = five(bits), middle = five(bits >> 5), high = five(bits >> 10);
    if (own && of_all_) return {low, middle, high, kOne};
    if (own) return {high, middle, low, kOne};
    if (of_all_) return {(*of_all_)[0], (*of_all_)[1], (*of_all_)[2], kOne};
    const std::uint32_t grey = linear_unit(mesh_material().diffuse.x);
    return {grey, grey, grey, kOne};
  }

 private:
  static constexpr std::uint32_t kMarked = 0x8000, kOne = 65535;

  std::uint32_t attribute(std::size_t facet) const {
    const char* const end = text_.data() + size_of_facets(facet + 1);
    return static_cast<unsigned char>(end[-2]) |
           static_cast<std::uint32_t>(static_cast<unsigned char>(end[-1])) << 8;
  }
  static std::uint32_t five(std::uint32_t bits) { return linear_unit_of_srgb((bits & 31) / 31.0); }
  static std::uint32_t code(char byte) {
    return linear_unit_of_srgb(static_cast<unsigned char>(byte) / 255.0);
  }

  std::string_view text_;
  std::size_t n_;
  std::optional<std::array<std::uint32_t, 3>> of_all_;  // Materialise's; none: VisCAM's convention
};

// Programs that write as they go leave the count at 0 or at its largest: then the count follows from the
// size.
std::size_t read_count(std::string_view text, const std::string& file, std::vector<std::string>& warnings) {
  const std::size_t counted = facet_count(text), bytes = text.size() - kHeaderBytes;
  const bool unset = counted == 0 || counted == 0xffffffffu;
  if (!unset || bytes == 0 || bytes % kFacetBytes != 0) return counted;
  warnings.push_back(file + ": its header counts " + std::to_string(counted) +
                     " facets, by its size it has " + std::to_string(bytes / kFacetBytes) +
                     ": these are read");
  return bytes / kFacetBytes;
}

void color_facet(Scene& scene, const std::array<std::uint32_t, 4>& color) {
  scene.texturing.colors.emplace_back();
  for (std::size_t corner = 0; corner < 3; ++corner) set_corner(scene.texturing.colors.back(), corner, color);
}

Scene read_binary(std::string_view text, const std::string& file) {
  if (text.size() < kHeaderBytes) {
    throw input_error(file, 0, "too short for an STL file", "its header takes 84 bytes");
  }
  Scene scene;
  const std::size_t n = read_count(text, file, scene.warnings), size = size_of_facets(n);
  if (text.size() < size) {
    throw input_error(file, 0,
                      "says " + std::to_string(n) + " facets, for which it is " +
                          std::to_string(size - text.size()) + " bytes too short",
                      "fetch it again");
  }
  if (text.size() > size) {
    scene.warnings.push_back(file + ": " + std::to_string(text.size() - size) +
                             " bytes after the last facet are left out");
  }
  const FacetColors colors(text, n);
  const bool colored = colors.any();
  scene.vertices.reserve(3 * n);
  scene.triangles.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const char* at = text.data() + size_of_facets(i) + 12;
    for (std::size_t corner = 0; corner < 3; ++corner, at += 12)
      scene.vertices.emplace_back(load_f32(at), load_f32(at + 4), load_f32(at + 8));
    const auto first = static_cast<std::uint32_t>(3 * i);
    scene.triangles.push_back(
        {.vertex = {first, first + 1, first + 2}, .number = static_cast<std::uint32_t>(i)});
    if (colored) color_facet(scene, colors.of(i));
  }
  settle_vertices(scene, [&](std::size_t v) { return file + ": facet " + std::to_string(v / 3); });
  return scene;
}

}  // namespace

Scene read_stl(std::string_view text, const std::filesystem::path& path) {
  const std::string file = path.string();
  const bool exact = text.size() >= kHeaderBytes && text.size() == size_of_facets(facet_count(text));
  const bool ascii = !exact && looks_like_text(text);
  Scene scene = ascii ? AsciiReader(text, file).read() : read_binary(text, file);
  scene.materials = {mesh_material()};
  if (!scene.texturing.colors.empty()) {
    MaterialMaps maps;
    scene.materials = {colored_mesh_material(maps)};
    scene.materials[0].maps = scene.texturing.add(maps);
  }
  return scene;
}

}  // namespace kdray::scene
