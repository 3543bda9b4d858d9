#include "scene/mtl.h"

#include <algorithm>
#include <array>

#include "scene/files_read.h"
#include "scene/line_scanner.h"
#include "scene/text_scanner.h"

namespace kdray::scene {

namespace {

class MtlReader {
 public:
  MtlReader(std::string_view text, const std::string& file, std::vector<MtlMaterial>& materials,
            std::vector<std::string>& warnings)
      : in_(text, file), materials_(materials), warnings_(warnings) {}

  void read() {
    while (in_.next_line()) {
      const std::string_view keyword = in_.word();
      if (keyword.empty()) continue;
      if (keyword == "newmtl") {
        materials_.emplace_back();
        materials_.back().name = in_.rest();
        current_ = true;
      } else if (current_) {
        read_statement(keyword, materials_.back());
      }
    }
  }

 private:
  void read_statement(std::string_view keyword, MtlMaterial& m) {
    if (keyword == "Kd") return read_color(keyword, m.kd);
    if (keyword == "Ks") return read_color(keyword, m.ks);
    if (keyword == "Ke") return read_color(keyword, m.ke);
    if (keyword == "Tf" || keyword == "Kt") return read_filter(keyword, m);
    if (keyword == "Ns") m.ns = std::max(0.0f, number(keyword));
    if (keyword == "Ni") m.ni = number(keyword);
    if (keyword == "d") m.dissolve = read_dissolve();
    if (keyword == "Tr") m.tr = std::clamp(number(keyword), 0.0f, 1.0f);
    if (keyword == "illum") m.illum = static_cast<int>(std::clamp(number(keyword), 0.0f, 10.0f));
    if (names_picture(keyword)) {
      const std::string_view rest = in_.rest();
      note_picture(rest);
      if (std::optional<MtlPicture>* const map = map_named(keyword, m)) *map = picture_of(keyword, rest, m);
    }
    if (means_nothing(keyword)) note_left_out(keyword, m);
  }

  static std::optional<MtlPicture>* map_named(std::string_view keyword, MtlMaterial& m) {
    if (keyword == "map_Kd") return &m.map_kd;
    if (keyword == "map_Ks") return &m.map_ks;
    if (keyword == "map_Ke") return &m.map_ke;
    if (keyword == "map_d") return &m.map_d;
    if (keyword == "norm" || keyword == "map_Kn") return &m.normals;
    if (keyword == "bump" || keyword == "map_bump" || keyword == "map_Bump") return &m.relief;
    return nullptr;
  }

  static bool names_picture(std::string_view keyword) {
    static constexpr std::array<std::string_view, 5> kOthers = {"bump", "disp", "decal", "refl", "norm"};
    return keyword.starts_with("map_") || std::ranges::find(kOthers, keyword) != kOthers.end();
  }

  // Options come before the name, and the name may hold spaces: it is the line from one of its words on.
  void note_picture(std::string_view rest) {
    while (!rest.empty()) {
      FilesRead::add_named(in_.file(), rest);
      const std::size_t gap = rest.find_first_of(" \t");
      if (gap == std::string_view::npos) return;
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t", gap), rest.size()));
    }
  }

  // Takes the next word off the front.
  static std::string_view take_word(std::string_view& rest) {
    const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t", end), rest.size()));
    return word;
  }

  // Up to three numbers; those that are not there leave what is in `out`.
  static void take_numbers(std::string_view& rest, std::array<double, 2>& out) {
    for (std::size_t i = 0; i < 3; ++i) {
      std::string_view after = rest;
      const std::string_view word = take_word(after);
      double value = 0;
      // The name of a file may look like a number.
      if (after.empty() || !read_number(word.data(), word.data() + word.size(), value)) return;
      if (i < 2) out[i] = std::clamp(value, -1e6, 1e6);
      rest = after;
    }
  }

  // Options stand before the name, which is all that is left then.
  MtlPicture picture_of(std::string_view keyword, std::string_view rest, MtlMaterial& m) {
    MtlPicture picture;
    while (rest.starts_with('-')) {
      std::string_view after = rest;
      const std::string_view option = take_word(after);
      if (after.empty()) break;
      if (option == "-s") {
        take_numbers(after, picture.scale);
      } else if (option == "-o") {
        take_numbers(after, picture.offset);
      } else if (option == "-clamp") {
        picture.clamp = take_word(after) == "on";
      } else if (option == "-bm") {
        std::array<double, 2> strength{1, 0};
        take_numbers(after, strength);
        picture.strength = std::clamp(strength[0], -1e3, 1e3);
      } else {
        skip_option(keyword, option, after, m);
      }
      rest = after;
    }
    picture.file = rest;
    return picture;
  }

  // Those whose absence shows are told. -t and -mm have several values.
  void skip_option(std::string_view keyword, std::string_view option, std::string_view& rest,
                   MtlMaterial& m) {
    std::array<double, 2> ignored{};
    if (option == "-t" || option == "-mm") {
      take_numbers(rest, ignored);
    } else {
      take_word(rest);
    }
    const bool shows = option == "-t" || option == "-mm" || option == "-imfchan" || option == "-cc";
    const std::string what = std::string(keyword) + " " + std::string(option);
    if (shows && std::ranges::find(m.left_out, what) == m.left_out.end()) m.left_out.push_back(what);
  }

  // What would change how the surface looks: further pictures, and terms of physically based shading.
  static bool means_nothing(std::string_view keyword) {
    constexpr std::string_view kLeftOut[] = {"map_Ns", "map_Tr", "disp",     "refl",  "decal", "map_Pr",
                                             "map_Pm", "map_Ps", "map_refl", "Pr",    "Pm",    "Ps",
                                             "Pc",     "Pcr",    "aniso",    "anisor"};
    return std::ranges::find(kLeftOut, keyword) != std::end(kLeftOut);
  }

  // A factor of 0 is how exporters say that there is none.
  void note_left_out(std::string_view keyword, MtlMaterial& m) {
    const std::string_view first = in_.word();
    double value = 1;
    const bool is_number = read_number(first.data(), first.data() + first.size(), value);
    if ((is_number && value == 0 && keyword != "Pr") ||
        std::ranges::find(m.left_out, keyword) != m.left_out.end())
      return;
    m.left_out.emplace_back(keyword);
  }

  // Brought into float's range, which is all that materials have.
  float number(std::string_view what) {
    constexpr double kMost = 1e30;
    return static_cast<float>(std::clamp(in_.number(what), -kMost, kMost));
  }

  // d FACTOR, or d -halo FACTOR for what fades towards its edges (taken as even).
  float read_dissolve() {
    const std::string_view first = in_.word();
    if (first == "-halo") return std::clamp(number("d"), 0.0f, 1.0f);
    double value = 0;
    if (!read_number(first.data(), first.data() + first.size(), value)) {
      throw in_.error("expected d (a finite number), found '" + printable(first) + "'");
    }
    return static_cast<float>(std::clamp(value, 0.0, 1.0));
  }

  // Three numbers, or one for a grey. Spectral files and CIE colours are left out, with a warning.
  void read_color(std::string_view keyword, vec3& color) {
    const std::string_view first = in_.word();
    if (first == "spectral" || first == "xyz") {
      warnings_.push_back(in_.file() + ":" + std::to_string(in_.line()) + ": '" + std::string(keyword) + " " +
                          std::string(first) + "' is left out: colours are red, green and blue here");
      return;
    }
    double r = 0;
    if (!read_number(first.data(), first.data() + first.size(), r)) {
      throw in_.error("expected " + std::string(keyword) + " (a finite number), found '" + printable(first) +
                      "'");
    }
    double g = r;
    double b = r;
    if (in_.try_number(keyword, g)) b = in_.number(keyword);
    constexpr double kMost = 1e30;
    color = vec3(glm::clamp(dvec3(r, g, b), dvec3(0), dvec3(kMost)));
  }

  void read_filter(std::string_view keyword, MtlMaterial& m) {
    vec3 filter(1);
    read_color(keyword, filter);
    m.tf = glm::min(filter, vec3(1));
  }

  LineScanner in_;
  std::vector<MtlMaterial>& materials_;
  std::vector<std::string>& warnings_;
  bool current_ = false;
};

}  // namespace

void read_mtl(std::string_view text, const std::string& file, std::vector<MtlMaterial>& materials,
              std::vector<std::string>& warnings) {
  MtlReader(text, file, materials, warnings).read();
}

}  // namespace kdray::scene
