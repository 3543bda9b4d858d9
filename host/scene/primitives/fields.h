// What    The fields of a shape as kdray's JSON scenes name them: the reader and the list of keys follow from
//         them.
#pragma once

#include <string_view>

namespace kdray::primitives {

enum class Meaning { point, direction, above_zero, at_least_zero, at_least_zero_or_left_out };

template <class Shape, class Value>
struct Field {
  std::string_view key;
  Value Shape::*member;
  Meaning meaning;
};
template <class Shape, class Value>
Field(std::string_view, Value Shape::*, Meaning) -> Field<Shape, Value>;

}  // namespace kdray::primitives
