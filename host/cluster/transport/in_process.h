// What    Ranks that are threads of one process. Tests run whole frames over them.
// Shape   Each rank has an inbox. A rank may end at any time; what is sent to it after that is lost.
#pragma once

#include <memory>
#include <vector>

#include "cluster/transport/transport.h"

namespace kdray::transport {

std::vector<std::unique_ptr<Transport>> in_process(int ranks);

}  // namespace kdray::transport
