#include "scene/primitives/kinds.h"

#include <string>

#include "base/error.h"

namespace kdray::primitives {

void throw_unknown_kind(std::uint32_t number) {
  throw Error(ErrorCode::internal, "no kind of primitive has the number " + std::to_string(number));
}

}  // namespace kdray::primitives
