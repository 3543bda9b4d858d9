// What    kdray._core: kdray's C++ interface for the Python half of the package (python/kdray), which has the
//         documented names, makes rows of arrays and gives results their shapes. Nobody else is to use it.
#include <nanobind/nanobind.h>

#include "errors.h"
#include "interrupt.h"
#include "parts.h"

NB_MODULE(_core, module) {
  using namespace kdray::python;
  add_errors(module);
  add_interrupts(module);
  const SceneClass scene = add_scene(module);
  add_queries(scene);
  add_pictures(module, scene);
  add_devices(module);
  add_page(module);
}
