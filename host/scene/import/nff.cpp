// What    The Neutral File Format of Haines' standard procedural database: v b l f c s p pp and comments.
// Shape   Tokens, not lines: what one command wants may go on over several lines. An `f` holds until the
//         next.
// Units   Angles in degrees; `angle` is the full vertical field of view.
// Errors  File and line of the word at fault, and what was expected.
// Source  E. Haines, "Neutral File Format", SPD 3.14; what its terms mean here is in docs/scenes.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "scene/import/load.h"
#include "scene/import/materials.h"
#include "scene/import/text_scanner.h"
#include "scene/model/check_scene.h"
#include "scene/model/polygon.h"

namespace kdray::scene {

namespace {

constexpr float kAmbient = 0.1f;
constexpr std::uint32_t kLargestPicture = 1u << 16;

class NffReader {
 public:
  NffReader(std::string_view text, const std::filesystem::path& file)
      : in_(text, file.string()), materials_(scene_.materials) {}

  Scene read() {
    while (!in_.at_end()) read_command(in_.word("a command"));
    share_light();
    if (unset_normals_ > 0) {
      warn(std::to_string(unset_normals_) +
           " normals of length 0 in 'pp' patches: those patches are shaded flat");
    }
    return std::move(scene_);
  }

 private:
  void read_command(std::string_view word) {
    if (word == "s") return read_sphere();
    if (word == "c") return read_cone();
    if (word == "p") return read_polygon();
    if (word == "pp") return read_patch();
    if (word == "f") return read_material();
    if (word == "l") return read_light();
    if (word == "b") return read_background();
    if (word == "v") return read_view();
    throw in_.error("expected a command (v b l f c s p pp), found '" + printable(word) + "'");
  }

  void warn(const std::string& what) { scene_.warnings.push_back(in_.file() + ": " + what); }

  vec3 color(std::string_view what) {
    const dvec3 c = in_.vector(what);
    if (c.x < 0 || c.y < 0 || c.z < 0) throw in_.error(std::string(what) + " is below 0");
    return checked(c, what);
  }

  // Values that a double holds but the float of a material does not would be infinite there.
  vec3 checked(const dvec3& c, std::string_view what) {
    const vec3 narrow(c);
    if (!is_finite(dvec3(narrow))) throw in_.error(std::string(what) + " is too large");
    return narrow;
  }

  float factor(std::string_view what) {
    const double value = in_.number(what);
    if (value < 0) throw in_.error(std::string(what) + " is below 0");
    return checked(dvec3(value), what).x;
  }

  void read_background() { scene_.background = color("the background colour (red green blue)"); }

  void read_light() {
    Light light;
    light.position = in_.vector("a light's position (x y z)");
    const bool has_color = in_.at_number();
    if (has_color) light.color = color("a light's colour (red green blue)");
    scene_.lights.push_back(light);
    has_color_.push_back(has_color);
  }

  // Lights without a colour share one unit of light such that a surface lit by all of them is not
  // overexposed.
  void share_light() {
    const auto share = static_cast<float>(1 / std::sqrt(static_cast<double>(scene_.lights.size())));
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
      if (!has_color_[i]) scene_.lights[i].color = vec3(share);
    }
  }

  void read_material() {
    const vec3 base = color("the colour of 'f' (red green blue)");
    const float kd = factor("Kd of 'f'");
    const float ks = factor("Ks of 'f'");
    Material m;
    m.shine = factor("the shine of 'f'");
    const float transmit = factor("T of 'f'");
    m.index = factor("the index of refraction of 'f'");
    if (m.index == 0 && transmit > 0) throw in_.error("an index of refraction of 0 on a transparent surface");
    if (m.index == 0) m.index = 1;
    m.ambient = kAmbient * base;
    m.diffuse = kd * base;
    m.specular = vec3(ks);
    m.reflect = vec3(ks);
    m.transmit = transmit * base;
    material_ = materials_.add(m);
  }

  std::uint32_t material() {
    if (!material_) {
      warn("a primitive before the first 'f' in line " + std::to_string(in_.line()) +
           ": it is white and matte");
      Material matte;
      matte.ambient = vec3(kAmbient);
      matte.diffuse = vec3(1);
      material_ = materials_.add(matte);
    }
    return *material_;
  }

  std::uint32_t next_number() { return number_++; }

  void read_sphere() {
    Sphere s;
    s.material = material();
    s.center = in_.vector("a sphere's center (x y z)");
    // A radius below 0 means "seen from inside", but spheres here are two-sided.
    s.radius = std::abs(in_.number("a sphere's radius"));
    if (s.radius == 0) throw in_.error("a sphere with a radius of 0");
    s.number = next_number();
    scene_.spheres.push_back(s);
  }

  void read_cone() {
    Cone c;
    c.material = material();
    c.base = in_.vector("a cone's base (x y z)");
    const double base_radius = in_.number("a cone's base radius");
    c.apex = in_.vector("a cone's apex (x y z)");
    const double apex_radius = in_.number("a cone's apex radius");
    c.base_radius = std::abs(base_radius);
    c.apex_radius = std::abs(apex_radius);
    if (c.base == c.apex) throw in_.error("a cone whose base and apex are the same point");
    if (c.base_radius == 0 && c.apex_radius == 0) throw in_.error("a cone with two radii of 0");
    c.number = next_number();
    scene_.cones.push_back(c);
  }

  // Returns the corner count of 'p' and 'pp', held against the bytes left: a number and its separator take
  // two.
  std::uint32_t corner_count(std::uint32_t numbers_per_corner) {
    const std::uint32_t n = in_.count("the number of corners of a polygon");
    if (n < 3) throw in_.error("a polygon of " + std::to_string(n) + " corners", "it needs 3 or more");
    const std::uint64_t least = std::uint64_t{n} * numbers_per_corner * 2;
    if (least > in_.bytes_left() + 1) {
      throw in_.error("a polygon of " + std::to_string(n) + " corners, but the file ends before that many");
    }
    return n;
  }

  void read_polygon() {
    const std::uint32_t mat = material();
    const std::uint32_t n = corner_count(3);
    const std::size_t first = add_vertices(n);
    add_triangles(first, n, mat, {});
  }

  std::size_t add_vertices(std::uint32_t n) {
    const std::size_t first = scene_.vertices.size();
    check_capacity(first + n);
    for (std::uint32_t i = 0; i < n; ++i) {
      vertex_reserve_.reserve(scene_.vertices, in_.bytes_left());
      scene_.vertices.push_back(in_.vector("a corner of a polygon (x y z)"));
    }
    return first;
  }

  void check_capacity(std::size_t n) const {
    if (n >= kNone) throw in_.error("more than 2^32 corners", "split the scene into several files");
  }

  void read_patch() {
    const std::uint32_t mat = material();
    const std::uint32_t n = corner_count(6);
    const std::size_t first = scene_.vertices.size();
    check_capacity(first + n);
    normals_.clear();
    for (std::uint32_t i = 0; i < n; ++i) {
      vertex_reserve_.reserve(scene_.vertices, in_.bytes_left());
      scene_.vertices.push_back(in_.vector("a corner of a patch (x y z)"));
      normals_.push_back(in_.vector("a normal of a patch (x y z)"));
    }
    add_triangles(first, n, mat, add_normals());
  }

  // Returns the place of the patch's first normal, or nothing when one of them has no direction: the
  // triangles then keep their own.
  std::optional<std::uint32_t> add_normals() {
    const auto first = static_cast<std::uint32_t>(scene_.normals.size());
    for (const dvec3& n : normals_) {
      // The vector is scaled first, so that no square overflows or vanishes.
      const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
      if (!(largest > 0)) {
        ++unset_normals_;
        scene_.normals.resize(first);
        return std::nullopt;
      }
      normal_reserve_.reserve(scene_.normals, in_.bytes_left());
      scene_.normals.emplace_back(glm::normalize(n / largest));
    }
    return first;
  }

  void add_triangles(std::size_t first_vertex, std::uint32_t n, std::uint32_t mat,
                     std::optional<std::uint32_t> first_normal) {
    const auto first = static_cast<std::uint32_t>(first_vertex);
    const auto add = [&](const std::array<std::uint32_t, 3>& corner) {
      Triangle t;
      for (int i = 0; i < 3; ++i) t.vertex[i] = first + corner[i];
      if (first_normal) {
        for (int i = 0; i < 3; ++i) t.normal[i] = *first_normal + corner[i];
      }
      t.material = mat;
      t.number = next_number();
      triangle_reserve_.reserve(scene_.triangles, in_.bytes_left());
      scene_.triangles.push_back(t);
    };
    if (n == 3) return add({0, 1, 2});  // most are, and need no list
    bool finished = true;
    for (const auto& corner : triangulate({scene_.vertices.data() + first_vertex, n}, &finished)) add(corner);
    if (!finished) scene_.warnings.push_back(in_.error(polygon_warning(n)).what());
  }

  void read_view() {
    if (scene_.camera) warn("a second 'v' in line " + std::to_string(in_.line()) + ": the last one counts");
    const std::uint32_t line = in_.line();
    View view;
    while (read_view_key(view, in_.peek())) {
    }
    const char* lacks = !view.has_from ? "from" : !view.has_at ? "at" : !view.has_angle ? "angle" : nullptr;
    if (lacks)
      throw input_error(in_.file(), line, std::string("the view 'v' lacks its '") + lacks + "' line");
    if (const char* fault = fault_of(view.camera))
      throw input_error(in_.file(), line, std::string("the view: ") + fault);
    scene_.camera = view.camera;
  }

  struct View {
    Camera camera;
    bool has_from = false, has_at = false, has_angle = false;
  };

  // Reads "key values" when `key` is one of the view's; the format wants them in one order, but any order is
  // taken.
  bool read_view_key(View& view, std::string_view key) {
    if (key == "from") {
      view.camera.from = after_key("the view's 'from' (x y z)");
      view.has_from = true;
    } else if (key == "at") {
      view.camera.at = after_key("the view's 'at' (x y z)");
      view.has_at = true;
    } else if (key == "up") {
      view.camera.up = after_key("the view's 'up' (x y z)");
    } else if (key == "angle") {
      in_.word(key);
      const double degrees = in_.number("the view's angle in degrees");
      if (!(degrees > 0 && degrees < 180))
        throw in_.error("the view's angle is not between 0 and 180 degrees");
      view.camera.vertical_fov = glm::radians(degrees);
      view.has_angle = true;
    } else if (key == "hither") {
      in_.word(key);
      view.camera.hither = in_.number("the view's hither distance");
      if (view.camera.hither < 0) throw in_.error("the view's hither distance is below 0");
    } else if (key == "resolution") {
      in_.word(key);
      scene_.settings.width = picture_side("the picture's width");
      scene_.settings.height = picture_side("the picture's height");
    } else {
      return false;
    }
    return true;
  }

  dvec3 after_key(std::string_view what) {
    in_.word(what);
    return in_.vector(what);
  }

  int picture_side(std::string_view what) {
    const std::uint32_t n = in_.count(what);
    if (n == 0 || n > kLargestPicture)
      throw in_.error(std::string(what) + " is not between 1 and 65536 pixels");
    return static_cast<int>(n);
  }

  TextScanner in_;
  Scene scene_;
  MaterialTable materials_;
  ReserveAhead vertex_reserve_, normal_reserve_, triangle_reserve_;
  std::optional<std::uint32_t> material_;  // of the last 'f'
  std::vector<bool> has_color_;            // per light
  std::vector<dvec3> normals_;             // of the patch being read
  std::uint32_t number_ = 0;
  std::size_t unset_normals_ = 0;
};

}  // namespace

Scene read_nff(std::string_view text, const std::filesystem::path& file) {
  return NffReader(text, file).read();
}

}  // namespace kdray::scene
