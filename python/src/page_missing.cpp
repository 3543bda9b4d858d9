// Stands in for the page in a package that was built without what it needs.
#include "parts.h"

namespace kdray::python {

void add_page(nanobind::module_&) {}

}  // namespace kdray::python
