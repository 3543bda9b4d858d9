#include "stress/traced.h"

#include <fmt/format.h>

namespace kdray::stress {

std::string in_words(const Ray& r) {
  return fmt::format("origin {:a} {:a} {:a} t_min {:a} direction {:a} {:a} {:a} t_max {:a}", r.origin[0],
                     r.origin[1], r.origin[2], r.t_min, r.direction[0], r.direction[1], r.direction[2],
                     r.t_max);
}

std::string in_words(const Hit& h) {
  return fmt::format(" -> t {:a} primitive {} u {:a} v {:a}", h.t, h.primitive, h.u, h.v);
}

}  // namespace kdray::stress
