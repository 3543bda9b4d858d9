// What    Haines' standard procedural database: scenes as NFF text, at any size.
// Source  E. Haines, "A proposal for standard graphics environments", IEEE CG&A 7(11), 1987, and the SPD
//         package.
#pragma once

#include <iosfwd>
#include <span>
#include <string_view>

namespace kdray::generate {

struct Generator {
  std::string_view name;         // "balls"
  std::string_view description;  // one line for --help
  int default_size;              // the SPD's own
  int min_size, max_size;
  void (*write)(std::ostream& out, int size);
};

std::span<const Generator> generators();

// Throws kdray::Error (ErrorCode::usage) naming what there is when `name` or `size` is not.
void generate(std::string_view name, int size, std::ostream& out);

}  // namespace kdray::generate
