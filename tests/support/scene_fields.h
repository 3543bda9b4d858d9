// What    The points and lengths of a scene's primitives changed one by one, whatever their kinds: moved,
//         scaled, rounded.
// Shape   Which is which, the shapes' own fields tell (primitives/shape_tools.h).
#pragma once

#include <tuple>

#include "scene/model/scene.h"

namespace kdray::test {

template <class Point, class Length>
void change_fields(scene::Scene& s, const Point& point, const Length& length) {
  for (dvec3& v : s.vertices) point(v);
  const auto change = [&](auto& shape, const auto& field) {
    auto& value = shape.*field.member;
    if constexpr (requires { length(value); })
      length(value);
    else if (field.meaning == primitives::Meaning::point)
      point(value);
  };
  primitives::for_each_shape([&](auto kind) {
    for (auto& shape : decltype(kind)::of(s))
      std::apply([&](const auto&... field) { (change(shape, field), ...); }, fields_of(&shape));
  });
}

// The primitives alone; lights and camera stay.
inline void scale_and_move(scene::Scene& s, double scale, const dvec3& offset) {
  change_fields(
      s, [&](dvec3& p) { p = p * scale + offset; }, [&](double& length) { length *= scale; });
}

}  // namespace kdray::test
