#include "scene/import/obj/mtl.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "scene/import/files.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene {

namespace {

class MtlReader {
 public:
  MtlReader(std::string_view text, const std::string& file, std::vector<MtlMaterial>& materials,
            std::vector<std::string>& warnings)
      : in_(text, file), materials_(materials), warnings_(warnings) {}

  void read() {
    while (in_.next_line()) {
      const std::string_view word = in_.word(), keyword = standard_spelling(word);
      if (word.empty()) continue;
      if (keyword == "newmtl") {
        materials_.emplace_back();
        materials_.back().name = unquoted(in_.rest());
        current_ = true;
      } else if (current_ && !keyword.empty()) {
        read_statement(keyword, materials_.back());
      } else if (current_) {
        left_out_.add("lines that are no MTL statements are left out", in_.line());
        if (same_word(word.substr(0, 4), "map_")) note_picture(in_.rest());
      } else {
        left_out_.add("statements before the first 'newmtl' are left out", in_.line());
      }
    }
    left_out_.warn(in_.file(), warnings_);
  }

 private:
  // Exporters write keywords in capitals of all kinds. Empty: there is no such keyword.
  static std::string_view standard_spelling(std::string_view keyword) {
    static constexpr std::array<std::string_view, 39> kKeywords = {
        "newmtl", "Kd",     "Ks",       "Ke",       "Tf",     "Kt",        "Ns",     "Ni",
        "d",      "Tr",     "illum",    "map_Kd",   "map_Ks", "map_Ke",    "map_d",  "norm",
        "map_Kn", "bump",   "map_Bump", "map_Ns",   "map_Tr", "disp",      "refl",   "decal",
        "map_Pr", "map_Pm", "map_Ps",   "map_refl", "Pr",     "Pm",        "Ps",     "Pc",
        "Pcr",    "aniso",  "anisor",   "Ka",       "map_Ka", "sharpness", "map_aat"};
    const auto* const found =
        std::ranges::find_if(kKeywords, [&](std::string_view known) { return same_word(known, keyword); });
    return found == kKeywords.end() ? "" : *found;
  }

  void read_statement(std::string_view keyword, MtlMaterial& m) {
    if (keyword == "Kd") return read_color(keyword, m.kd);
    if (keyword == "Ks") return read_color(keyword, m.ks);
    if (keyword == "Ke") return read_color(keyword, m.ke);
    if (keyword == "Tf" || keyword == "Kt") return read_filter(keyword, m);
    if (keyword == "Ns") return read_number_of(keyword, 0, 1e30f, m.ns);
    if (keyword == "Ni") return read_number_of(keyword, -1e30f, 1e30f, m.ni);
    if (keyword == "d") return read_dissolve(m);
    if (keyword == "Tr") return read_number_of(keyword, 0, 1, m.tr);
    if (keyword == "illum") return read_number_of(keyword, 0, 10, m.illum);
    if (names_picture(keyword)) {
      const std::string_view rest = in_.rest();
      note_picture(rest);
      if (std::optional<MtlPicture>* const map = map_named(keyword, m)) {
        *map = picture_of(keyword, rest, m);
      } else if (!means_nothing(keyword)) {
        note_left_out(keyword, rest, m);
      }
    } else if (!means_nothing(keyword)) {
      note_left_out(keyword, in_.word(), m);
    }
  }

  static std::optional<MtlPicture>* map_named(std::string_view keyword, MtlMaterial& m) {
    if (keyword == "map_Kd") return &m.map_kd;
    if (keyword == "map_Ks") return &m.map_ks;
    if (keyword == "map_Ke") return &m.map_ke;
    if (keyword == "map_d") return &m.map_d;
    if (keyword == "norm" || keyword == "map_Kn") return &m.normals;
    if (keyword == "bump" || keyword == "map_Bump") return &m.relief;
    return nullptr;
  }

  static bool names_picture(std::string_view keyword) {
    static constexpr std::array<std::string_view, 5> kOthers = {"bump", "disp", "decal", "refl", "norm"};
    return keyword.starts_with("map_") || std::ranges::find(kOthers, keyword) != kOthers.end();
  }

  // Options come before the name, and the name may hold spaces: it is the line from one of its words on.
  void note_picture(std::string_view rest) {
    while (!rest.empty()) {
      FilesRead::add_named(in_.file(), unquoted(rest));
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

  // Options whose absence shows are reported. -t and -mm have several values.
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

  // Ambient light follows from the diffuse colour (whitted_from_mtl); the others say how a picture is
  // filtered.
  static bool means_nothing(std::string_view keyword) {
    return keyword == "Ka" || keyword == "map_Ka" || keyword == "sharpness" || keyword == "map_aat";
  }

  // What would change how the surface looks: further pictures, and terms of physically based shading. A
  // factor of 0 is how exporters say that there is none.
  static void note_left_out(std::string_view keyword, std::string_view first, MtlMaterial& m) {
    double value = 1;
    const bool is_number = read_number(first.data(), first.data() + first.size(), value);
    if ((is_number && value == 0 && keyword != "Pr") ||
        std::ranges::find(m.left_out, keyword) != m.left_out.end())
      return;
    m.left_out.emplace_back(keyword);
  }

  void note_no_number(std::string_view keyword) {
    left_out_.add("values of '" + std::string(keyword) + "' are not finite numbers: its default holds",
                  in_.line());
  }

  // The next word, brought into a range; what is no finite number leaves `out` alone.
  template <class T>
  void read_number_of(std::string_view keyword, float least, float most, T& out) {
    const std::string_view word = in_.word();
    double value = 0;
    if (!read_number(word.data(), word.data() + word.size(), value)) return note_no_number(keyword);
    const float number = static_cast<float>(std::clamp<double>(value, least, most));
    if constexpr (std::is_same_v<T, std::optional<int>>) {
      out = static_cast<int>(number);
    } else {
      out = number;
    }
  }

  // d FACTOR, or d -halo FACTOR for what fades towards its edges (taken as even).
  void read_dissolve(MtlMaterial& m) {
    std::string_view word = in_.word();
    if (word == "-halo") word = in_.word();
    double value = 0;
    if (!read_number(word.data(), word.data() + word.size(), value)) return note_no_number("d");
    m.dissolve = static_cast<float>(std::clamp(value, 0.0, 1.0));
  }

  // Three numbers, or one for a grey. Spectral files and CIE colours are left out, with a warning.
  void read_color(std::string_view keyword, vec3& color) {
    const std::string_view first = in_.word();
    if (first == "spectral" || first == "xyz")
      return left_out_.add("values '" + std::string(keyword) + " " + std::string(first) +
                               "' are left out: colours are red, green and blue here",
                           in_.line());
    const std::string_view second = in_.word(), third = in_.word();
    const auto read = [](std::string_view word, double& value) {
      return read_number(word.data(), word.data() + word.size(), value);
    };
    dvec3 rgb(0);
    if (!read(first, rgb.x)) return note_no_number(keyword);
    if (second.empty()) {
      rgb = dvec3(rgb.x);
    } else if (!read(second, rgb.y) || !read(third, rgb.z)) {
      return note_no_number(keyword);
    }
    constexpr double kMost = 1e30;
    color = vec3(glm::clamp(rgb, dvec3(0), dvec3(kMost)));
  }

  void read_filter(std::string_view keyword, MtlMaterial& m) {
    vec3 filter(-1);
    read_color(keyword, filter);
    if (filter.x >= 0) m.tf = glm::min(filter, vec3(1));
  }

  LineScanner in_;
  std::vector<MtlMaterial>& materials_;
  std::vector<std::string>& warnings_;
  LeftOut left_out_;
  bool current_ = false;
};

}  // namespace

void read_mtl(std::string_view text, const std::string& file, std::vector<MtlMaterial>& materials,
              std::vector<std::string>& warnings) {
  MtlReader(text, file, materials, warnings).read();
}

// ---- in the terms of the Whitted model

namespace {

// Ka is not used: most exporters write 1 1 1 or the diffuse colour there, which would drown the lights.
constexpr float kAmbientShare = 0.1f;

// MTL's illumination models differ in which terms are on.
bool has_highlight(int illum) {
  return illum >= 2 && illum <= 9;
}
bool has_mirror(int illum) {
  return illum >= 3 && illum <= 9;
}
bool has_refraction(int illum) {
  return illum == 4 || illum == 6 || illum == 7 || illum == 9;
}
bool has_fresnel(int illum) {
  return illum == 5 || illum == 7;
}

// Schlick's reflectance averaged over a hemisphere of directions, for surfaces that can't vary it with the
// angle.
float mean_fresnel(float index) {
  const float r = (index - 1) / (index + 1);
  const float normal = r * r;
  return normal + (1 - normal) / 21;
}

float opacity(const MtlMaterial& mtl) {
  if (mtl.dissolve) return *mtl.dissolve;
  return mtl.tr ? 1 - *mtl.tr : 1;
}

// Returns what goes through: 1 - d, coloured by Tf. A refracting material that only has Tf is as transparent
// as that; but illum 4, Tf 1 1 1 and Ni 1 is how Maya writes what is opaque.
vec3 transmit_of(const MtlMaterial& mtl, int illum) {
  const float through = 1 - opacity(mtl);
  if (!has_refraction(illum)) return vec3(through);
  if (through > 0) return through * mtl.tf.value_or(vec3(1));
  const vec3 filter = mtl.tf.value_or(vec3(0));
  return illum == 4 && filter == vec3(1) && mtl.ni == 1 ? vec3(0) : filter;
}

float largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

// A surface can't send on more light than it gets.
void share_energy(int illum, Material& m) {
  const float sum = largest(m.reflect + m.transmit);
  if (sum <= 1) return;
  if (has_fresnel(illum) && largest(m.transmit) > 0) {
    m.reflect = glm::min(m.reflect, vec3(1)) * mean_fresnel(m.index);
    m.transmit *= 1 - largest(m.reflect);
  } else {
    m.reflect /= sum;
    m.transmit /= sum;
  }
}

}  // namespace

bool is_invisible(const MtlMaterial& mtl) {
  const int illum = mtl.illum.value_or(2);
  const bool shines = mtl.ke != vec3(0) || mtl.map_ke || (has_mirror(illum) && mtl.ks != vec3(0));
  return opacity(mtl) == 0 && !shines && !(has_refraction(illum) && mtl.ni != 1);
}

Material whitted_from_mtl(const MtlMaterial& mtl, bool has_picture) {
  const int illum = mtl.illum.value_or(2);
  vec3 kd = mtl.kd;
  // A picture is multiplied by Kd, but black is how exporters say that it alone counts. Without the picture,
  // black would be a black object.
  if (mtl.map_kd && kd == vec3(0)) kd = vec3(has_picture ? 1.0f : 0.6f);
  Material m;
  m.emission = mtl.ke;
  m.transmit = transmit_of(mtl, illum);
  m.diffuse = kd * opacity(mtl);
  m.ambient = kAmbientShare * m.diffuse;
  // (R.V)^0 is 1 all over the surface: Ns 0 is how exporters say that there is no highlight.
  if (has_highlight(illum) && mtl.ns > 0) {
    m.specular = mtl.ks;
    m.shine = mtl.ns;
  }
  if (has_mirror(illum)) m.reflect = mtl.ks;
  // Dissolved surfaces are not solid: they don't bend light.
  if (has_refraction(illum) && mtl.ni > 0) m.index = mtl.ni;
  share_energy(illum, m);
  return m;
}

}  // namespace kdray::scene
