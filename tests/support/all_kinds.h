// What    The list of kinds as the types of a typed test, named as the kinds are: a kind that is added to
//         kernels/layout/kinds.h is held to the test, and fails by its name.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "scene/primitives/shapes.h"

namespace kdray::test {

#define KDRAY_ANOTHER_KIND(NAME, name, names, Struct) , primitives::Struct##Kind
using AllKinds = testing::Types<primitives::TriangleKind KDRAY_SHAPES(KDRAY_ANOTHER_KIND)>;
#undef KDRAY_ANOTHER_KIND

// All but triangles.
template <class Triangles, class... Shapes>
testing::Types<Shapes...> shapes_of(testing::Types<Triangles, Shapes...>);
using AllShapes = decltype(shapes_of(AllKinds()));

struct KindNames {
  template <class Kind>
  static std::string GetName(int) {
    return Kind::kName;
  }
};

}  // namespace kdray::test
