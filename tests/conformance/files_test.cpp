// What every kind but triangles owes to files: kdray's JSON reads it by the names of its fields; and what it
// owes to programs: they give it in arrays.
#include <fmt/format.h>

#include <fstream>
#include <list>

#include "conformance/all_kinds.h"
#include "kdray/scene.h"
#include "scene/import/load.h"
#include "scene/scratch.h"
#include "support/errors.h"

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

// And a program's arrays by the same fields' plurals, in any order, rounded nowhere.
TYPED_TEST(FilesOf, AreMadeOfArrays) {
  if constexpr (TypeParam::kIsShape) {
    using Source = typename TypeParam::Source;
    const scene::Scene s = scene_of<TypeParam>(5, 1);
    const std::vector<Source>& shapes = TypeParam::of(s);
    std::list<std::vector<double>> memory;
    Shapes arrays{TypeParam::kNames, {}};
    const auto add = [&](const auto& field) {
      std::vector<double>& rows = memory.emplace_back();
      for (const Source& shape : shapes)
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape.*field.member)>, dvec3>)
          for (int k = 0; k < 3; ++k) rows.push_back((shape.*field.member)[k]);
        else
          rows.push_back(shape.*field.member);
      const std::string name(field.array);
      if (rows.size() == shapes.size())
        arrays.fields.insert(arrays.fields.begin(), {name, Values(rows)});
      else
        arrays.fields.insert(arrays.fields.begin(), {name, Points(rows)});
    };
    std::apply([&](const auto&... field) { (add(field), ...); },
               fields_of(static_cast<const Source*>(nullptr)));
    Scene made;
    EXPECT_EQ(made.add_shapes(arrays), 0u);
    const std::vector<Source>& found = TypeParam::of(made.model());
    ASSERT_EQ(found.size(), shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i)
      std::apply(
          [&](const auto&... field) {
            EXPECT_TRUE(((found[i].*field.member == shapes[i].*field.member) && ...)) << i;
          },
          fields_of(&shapes[i]));
    arrays.fields.push_back({"weights", Values(memory.back())});
    EXPECT_TRUE(fails([&] { made.add_shapes(arrays); }, std::string(TypeParam::kNames) + " have no weights",
                      ErrorCode::usage));
    arrays.fields.back() = arrays.fields.front();
    EXPECT_TRUE(fails([&] { made.add_shapes(arrays); }, "given twice", ErrorCode::usage));
    arrays.fields.resize(1);
    EXPECT_TRUE(fails([&] { made.add_shapes(arrays); }, ": none are given"));
    EXPECT_EQ(made.geometries().size(), 1u);
  }
}

}  // namespace
}  // namespace kdray::test
