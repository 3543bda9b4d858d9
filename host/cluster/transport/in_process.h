// What    Ranks that are threads of one process: what tests run whole frames over.
// Shape   An inbox for each rank. A rank may end at any time; what is sent to it then is lost.
#pragma once

#include <memory>
#include <vector>

#include "cluster/transport/transport.h"

namespace kdray::transport {

std::vector<std::unique_ptr<Transport>> in_process(int ranks);

}  // namespace kdray::transport
