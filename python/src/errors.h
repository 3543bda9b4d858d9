// What    kdray::Error as Python's exceptions: kdray.Error and its kinds, which are also ValueError,
//         MemoryError or RuntimeError.
#pragma once

#include <nanobind/nanobind.h>

namespace kdray::python {

void add_errors(nanobind::module_& module);

}  // namespace kdray::python
