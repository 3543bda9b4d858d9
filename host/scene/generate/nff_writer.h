// What    Writes the entities of Haines' neutral file format (NFF), one call each; and the scenes that are
//         written with it.
// Shape   Numbers carry 9 significant digits: enough for every float, so that a vertex shared by two polygons
//         is the same after reading. Values below 1e-12 are written as 0: they are what a rotation's rounding
//         left of it.
// Errors  None of its own; the caller looks at the stream's state.
// Source  E. Haines, NFF 3.1, in the SPD package.
#pragma once

#include <initializer_list>
#include <iosfwd>
#include <span>
#include <string>

#include "base/vec.h"

namespace kdray::generate {

struct View {
  dvec3 from, at, up;
  double angle;  // degrees, of the whole picture
  double hither;
  int resolution = 512;  // square
};

// What an `f` entity says of a surface.
struct Surface {
  dvec3 color;
  double diffuse, specular;
  double shine = 100000;  // SPD's value for "no highlight to speak of"
  double transmit = 0;
  double index = 0;
};

struct PatchVertex {
  dvec3 position, normal;
};

inline constexpr dvec3 kSkyBlue{0.078, 0.361, 0.753};  // SPD's usual background

class NffWriter {
 public:
  explicit NffWriter(std::ostream& out) : out_(out) {}

  void background(const dvec3& color);
  void view(const View& v);
  void light(const dvec3& position);
  void surface(const Surface& s);
  void sphere(const dvec3& center, double radius);
  void cone(const dvec3& base, double base_radius, const dvec3& apex, double apex_radius);
  void polygon(std::span<const dvec3> vertices);
  void polygon(std::initializer_list<dvec3> vertices) {
    polygon(std::span(vertices.begin(), vertices.size()));
  }
  void patch(std::span<const PatchVertex> vertices);

 private:
  void number(double value);
  void vector(const dvec3& v);
  void end_line();

  std::ostream& out_;
  std::string line_;
};

// ---- The scenes that generate.cpp lists, written with it.

void write_balls(std::ostream& out, int size);
void write_gears(std::ostream& out, int size);
void write_jacks(std::ostream& out, int size);
void write_lattice(std::ostream& out, int size);
void write_mount(std::ostream& out, int size);
void write_rings(std::ostream& out, int size);
void write_shells(std::ostream& out, int size);
void write_sombrero(std::ostream& out, int size);
void write_teapot(std::ostream& out, int size);
void write_tetra(std::ostream& out, int size);
void write_tree(std::ostream& out, int size);

}  // namespace kdray::generate
