// What    The list of the generators, and the check of their sizes.
// Shape   The largest sizes are those whose files still have fewer than 10^8 primitives.
#include "scene/generate/generate.h"

#include <array>
#include <ostream>
#include <string>

#include "base/error.h"
#include "scene/generate/nff_writer.h"

namespace kdray::generate {

namespace {

constexpr std::array kGenerators{
    Generator{"balls", "sphereflake: sum of 9^i spheres, i up to the size, on a floor", 4, 0, 8, write_balls},
    Generator{"gears", "size^3 meshing gears of concave polygons, some of glass", 4, 1, 88, write_gears},
    Generator{"mount", "fractal mountain of 2*4^size triangles, four glass spheres", 6, 0, 12, write_mount},
    Generator{"rings", "pyramid of dodecahedral rings: 5n(n+1)(2n+1) spheres and as many cones", 7, 1, 170,
              write_rings},
    Generator{"teapot", "Newell's teapot, size x size quads a patch, on a checkerboard", 6, 1, 1240,
              write_teapot},
    Generator{"tetra", "Sierpinski tetrahedron of 4^size triangles", 6, 1, 13, write_tetra},
    Generator{"tree", "branching tree of 2^(size+1)-1 cones and as many spheres", 11, 0, 24, write_tree},
    Generator{"lattice", "cubic lattice of (size+1)^3 spheres joined by cylinders", 12, 1, 291,
              write_lattice},
    Generator{"shells", "seashell of 180*2^size+1 overlapping spheres", 5, 1, 19, write_shells},
    Generator{"sombrero", "height field of 2*(2^(size+4)-1)^2 triangles", 1, 1, 8, write_sombrero},
    Generator{"jacks", "jacks in the octants of jacks, size levels of them", 1, 1, 8, write_jacks},
};

const Generator& find(std::string_view name) {
  std::string names;
  for (const Generator& g : kGenerators) {
    if (g.name == name) return g;
    names += names.empty() ? "" : ", ";
    names += g.name;
  }
  throw Error(ErrorCode::usage,
              "there is no scene '" + std::string(name) + "' to generate; there are " + names);
}

}  // namespace

std::span<const Generator> generators() {
  return kGenerators;
}

void generate(std::string_view name, int size, std::ostream& out) {
  const Generator& g = find(name);
  if (size < g.min_size || size > g.max_size)
    throw Error(ErrorCode::usage, std::string(name) + " can't be made at size " + std::to_string(size) +
                                      "; choose a size from " + std::to_string(g.min_size) + " to " +
                                      std::to_string(g.max_size));
  out << "# kdray generate " << name << " --size " << std::to_string(size)
      << ": Haines' standard procedural database\n";
  g.write(out, size);
}

}  // namespace kdray::generate
