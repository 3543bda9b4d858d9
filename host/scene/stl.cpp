// What    STL, ascii and binary. Facets are flat: the normals in the file are ignored (many files have them
//         wrong). Colours, in the header or the attribute bytes, are left out, with a warning.
// Shape   A binary file is told by its size, which its facet count gives exactly: many binary files begin
//         with the word "solid", too.
// Errors  ascii: file and line; binary: file and facet.
#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/add_polygon.h"
#include "scene/importers.h"
#include "scene/mesh_material.h"
#include "scene/text_scanner.h"

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

std::size_t binary_size(std::string_view text) {
  return kHeaderBytes + kFacetBytes * std::size_t{load_u32(text.data() + kHeaderBytes - 4)};
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, lower);
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
    expect("solid");
    skip_line();
    while (!in_.at_end()) {
      const std::string_view word = in_.peek();
      if (same_word(word, "facet")) {
        read_facet();
      } else if (same_word(word, "endsolid") || same_word(word, "solid")) {
        in_.word("endsolid");
        skip_line();
      } else {
        throw in_.expected("facet or endsolid");
      }
    }
    return std::move(scene_);
  }

 private:
  void expect(std::string_view wanted) {
    if (!same_word(in_.peek(), wanted)) throw in_.expected("'" + std::string(wanted) + "'");
    in_.word(wanted);
  }

  // A solid's name: whatever is left of the line, or, in a file that is one line, up to what can't be a name.
  void skip_line() {
    const std::uint32_t line = in_.line();
    while (!in_.at_end() && in_.line() == line && !begins_statement()) in_.word("a name");
  }

  bool begins_statement() {
    const std::string_view word = in_.peek();
    if (same_word(word, "endsolid")) return true;
    if (!same_word(word, "facet")) return false;
    TextScanner ahead = in_;
    ahead.word("facet");
    return same_word(ahead.peek(), "normal");
  }

  void read_facet() {
    expect("facet");
    expect("normal");
    // The numbers of a normal may be anything, even "1.#IND".
    const std::uint32_t line = in_.line();
    while (!in_.at_end() && in_.line() == line && !same_word(in_.peek(), "outer")) in_.word("a normal");
    expect("outer");
    expect("loop");
    corners_.clear();
    while (same_word(in_.peek(), "vertex")) {
      in_.word("vertex");
      corners_.push_back(static_cast<std::uint32_t>(scene_.vertices.size()));
      scene_.vertices.push_back(in_.vector("a vertex of three numbers"));
    }
    if (corners_.size() < 3) throw in_.expected("three lines 'vertex X Y Z'");
    add_polygon(scene_, corners_, {}, 0);
    expect("endloop");
    expect("endfacet");
  }

  TextScanner in_;
  Scene scene_;
  std::vector<std::uint32_t> corners_;
};

// Facets that say that they have a colour of their own. By VisCAM's convention the highest bit of the
// attribute says so; by Materialise's, whose header has a colour for all, that the facet has that one.
std::size_t colored_facets(std::string_view text, std::size_t n) {
  if (text.substr(0, kHeaderBytes - 4).find("COLOR=") != std::string_view::npos) return n;
  std::size_t colored = 0;
  for (std::size_t i = 0; i < n; ++i)
    colored += (static_cast<unsigned char>(text[kHeaderBytes + (i + 1) * kFacetBytes - 1]) & 0x80) != 0;
  return colored;
}

Scene read_binary(std::string_view text, const std::string& file) {
  if (text.size() < kHeaderBytes) {
    throw input_error(file, 0, "too short for an STL file", "its header takes 84 bytes");
  }
  const std::size_t size = binary_size(text);
  const std::size_t n = (size - kHeaderBytes) / kFacetBytes;
  if (text.size() < size) {
    throw input_error(file, 0,
                      "says " + std::to_string(n) + " facets, for which it is " +
                          std::to_string(size - text.size()) + " bytes too short",
                      "fetch it again");
  }
  Scene scene;
  if (text.size() > size) {
    scene.warnings.push_back(file + ": " + std::to_string(text.size() - size) +
                             " bytes after the last facet are left out");
  }
  if (const std::size_t colored = colored_facets(text, n); colored > 0)
    scene.warnings.push_back(file + ": the colours of " + std::to_string(colored) + " facets are left out");
  scene.vertices.reserve(3 * n);
  scene.triangles.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const char* at = text.data() + kHeaderBytes + i * kFacetBytes + 12;
    for (std::size_t corner = 0; corner < 3; ++corner, at += 12) {
      const dvec3 v(load_f32(at), load_f32(at + 4), load_f32(at + 8));
      if (!is_finite(v)) {
        throw input_error(file, 0, "facet " + std::to_string(i) + ": a coordinate is not finite",
                          "export the mesh again");
      }
      scene.vertices.push_back(v);
    }
    const auto first = static_cast<std::uint32_t>(3 * i);
    scene.triangles.push_back(
        {.vertex = {first, first + 1, first + 2}, .number = static_cast<std::uint32_t>(i)});
  }
  return scene;
}

}  // namespace

Scene read_stl(std::string_view text, const std::filesystem::path& path) {
  const std::string file = path.string();
  const bool exact = text.size() >= kHeaderBytes && text.size() == binary_size(text);
  const bool ascii = !exact && looks_like_text(text);
  Scene scene = ascii ? AsciiReader(text, file).read() : read_binary(text, file);
  if (scene.triangles.empty()) scene.warnings.push_back(file + ": no facets");
  scene.materials = {mesh_material()};
  return scene;
}

}  // namespace kdray::scene
