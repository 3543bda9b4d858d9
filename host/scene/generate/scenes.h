// What    The generators behind the registry, one file each.
#pragma once

#include <iosfwd>

namespace kdray::generate {

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
