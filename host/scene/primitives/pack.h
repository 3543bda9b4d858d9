// What    Vectors of the host into those of the kernels' structs.
#pragma once

#include "base/vec.h"

namespace kdray::primitives {

inline void set(float (&out)[3], const vec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}

}  // namespace kdray::primitives
