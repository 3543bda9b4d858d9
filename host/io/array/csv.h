// What    Columns as a CSV text: a line of names, then one for each row, numbers as short as they can be to
//         be read back as they are.
// Shape   A column of several values to a row has a name for each: point_x, point_y, point_z.
#pragma once

#include <span>

#include "io/array/table.h"

namespace kdray::array {

// Columns are of one length.
void write_csv(std::span<const Column> columns, const Sink& sink);

}  // namespace kdray::array
