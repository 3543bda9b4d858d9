// What every kind but triangles owes to files: kdray's JSON reads it by the names of its fields.
#include <fmt/format.h>

#include <fstream>

#include "conformance/all_kinds.h"
#include "scene/import/load.h"
#include "scene/scratch.h"

namespace kdray::test {
namespace {

template <class Kind>
class FilesOf : public testing::Test {};
TYPED_TEST_SUITE(FilesOf, AllKinds, KindNames);

std::string json(double v) {
  return fmt::format("{:.17g}", v);
}
std::string json(const dvec3& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x, v.y, v.z);
}

TYPED_TEST(FilesOf, AreReadByTheirFields) {
  if constexpr (TypeParam::kIsShape) {
    using Source = typename TypeParam::Source;
    const scene::Scene s = scene_of<TypeParam>(5, 1);
    std::string objects;
    for (const Source& shape : TypeParam::of(s)) {
      objects += fmt::format(R"({}{{"type": "{}")", objects.empty() ? "" : ", ", TypeParam::kName);
      std::apply(
          [&](const auto&... field) {
            ((objects += fmt::format(R"(, "{}": {})", field.key, json(shape.*field.member))), ...);
          },
          fields_of(static_cast<const Source*>(nullptr)));
      objects += "}";
    }
    const ScratchFolder folder;
    const scene::Scene read =
        scene::load(folder.write("kind.json", R"({"kdray": 1, "objects": [)" + objects + "]}"));
    ASSERT_EQ(TypeParam::of(read).size(), 5u);
    EXPECT_EQ(read.primitive_count(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
      const DBox a = bounds_of(TypeParam::of(s)[i]), b = bounds_of(TypeParam::of(read)[i]);
      EXPECT_LT(glm::length(a.lo - b.lo) + glm::length(a.hi - b.hi), 1e-12) << objects;
    }
  }
}

}  // namespace
}  // namespace kdray::test
