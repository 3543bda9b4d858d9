// What    A scene with answers known in closed form, traced and rendered on a device: does it compute
//         rightly?
// Shape   Empty when all is right, else what is wrong, one line.
#pragma once

#include <string>

namespace kdray::cli {

std::string self_test(const std::string& device);

}  // namespace kdray::cli
