// What    Makes a picture of the film's sums, where the device has memory of its own: half as much is read
//         from it then.
// Shape   item i makes value i.
// Cost    reads 8 B, writes 4 B.
// Errors  The sum is rounded to a double, the product again, and that to a float, as
//         host/engine/wavefront/develop.cpp has it.
#include "layout/arguments.h"

#pragma OPENCL EXTENSION cl_khr_fp64 : enable

__kernel void develop(KDRAY_PARAMETERS(KDRAY_DEVELOP_ARGUMENTS)) {
  const u64 i = get_global_id(0);
  if (i < n_values) out_values[i] = convert_float(convert_double(in_film[i]) * scale);
}
