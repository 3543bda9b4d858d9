// What    The names of choices, as the command line takes them and the statistics give them.
#pragma once

#include "kdray/kdray.h"

namespace kdray::api {

const char* name_of(Traversal traversal);
const char* name_of(Precision precision);
const char* name_of(Division division);
const char* name_of(Balance balance);

}  // namespace kdray::api
