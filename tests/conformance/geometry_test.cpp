// What every kind owes the scene and the tree: faults refused; bounds and clipping that contain the surface,
// whatever the rounding, held against random points of it in long double.
#include <algorithm>
#include <cmath>

#include "accel/flatten/features.h"
#include "accel/flatten/flatten.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/clip.h"
#include "base/error.h"
#include "conformance/all_kinds.h"
#include "scene/model/check_scene.h"
#include "scene/model/instances.h"
#include "support/scene_fields.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 20261123;
constexpr Real kRounding = 0x1p-48L;  // more than that of points in long double, of coordinates below 2^12

template <class Kind>
class GeometryOf : public testing::Test {
 protected:
  GeometryOf() : scene_(scene_of<Kind>(200, kSeed)), geometry_(scene::make_geometry(scene_)) {}
  const auto& kept() const { return Kind::of(geometry_); }
  RealPoint point(std::size_t i) { return Samples<Kind>::point(kept()[i], random_); }

  scene::Scene scene_;
  scene::Geometry geometry_;
  Draw random_{kSeed};
};
TYPED_TEST_SUITE(GeometryOf, AllKinds, KindNames);

bool holds(const Box& b, const RealPoint& p) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < Real(b.lo[k]) - kRounding || p[k] > Real(b.hi[k]) + kRounding) return false;
  return true;
}

TYPED_TEST(GeometryOf, KeepsAllAndCountsWhatItDrops) {
  scene::check_scene(this->scene_);
  EXPECT_EQ(this->kept().size() + this->geometry_.dropped_degenerate, 200u);
  EXPECT_EQ(this->geometry_.size(), this->kept().size());
}

TYPED_TEST(GeometryOf, BoundsContainTheSurface) {
  for (std::size_t i = 0; i < this->kept().size(); ++i)
    for (int sample = 0; sample < 50; ++sample) {
      const RealPoint p = this->point(i);
      ASSERT_TRUE(holds(scene::bounds_of(this->kept()[i]), p)) << "number " << i << ", seed " << kSeed;
      ASSERT_TRUE(holds(this->geometry_.bounds, p));
    }
}

// The kernels' bounds, of which the core is made, are wider than the tree's, by little.
TYPED_TEST(GeometryOf, GenerousBoundsContainTheOthers) {
  if constexpr (TypeParam::kIsShape)
    for (const auto& shape : this->kept()) {
      const Box exact = bounds_of(shape), generous = primitives::bounds_of(pack(shape));
      EXPECT_TRUE(generous.contains(exact));
      EXPECT_LT(glm::length(generous.extent()), 1.1f * glm::length(exact.extent()) + 1);
    }
}

// Gives a shape that has an axis this one.
template <class Shape>
void turn(Shape& shape, const vec3& axis) {
  if constexpr (requires { shape.axis; }) shape.axis = axis;
  if constexpr (requires { shape.normal; }) shape.normal = axis;
  if constexpr (requires { shape.apex; })
    shape.apex = shape.base + glm::distance(shape.base, shape.apex) * axis;
}

// Where an axis is nearly that of a coordinate, 1 less its square is nearly nothing but rounding.
TYPED_TEST(GeometryOf, GenerousBoundsContainThoseOfNearlyUprightShapes) {
  if constexpr (TypeParam::kIsShape)
    for (auto shape : this->kept())
      for (int k = 0; k < 400; ++k) {
        const float tilt = 1e-5f * std::pow(1.02f, static_cast<float>(k));
        turn(shape, glm::normalize(vec3(0.3f * tilt, 1, tilt)));
        ASSERT_TRUE(primitives::bounds_of(pack(shape)).contains(bounds_of(shape))) << "tilted by " << tilt;
      }
}

kdtree::SplitBounds split(const scene::Geometry& g, kdtree::Ref ref, const Bounds& cell, int axis, float at) {
  kdtree::BoundedRef r{cell.lo, ref, cell.hi};
  return kdtree::clip_to_sides(g, r, cell, axis, at);
}

// Both parts of a cell contain what is of the surface in them; where a part comes out empty there is nothing.
TYPED_TEST(GeometryOf, ClippingLosesNothing) {
  int inside = 0;
  for (std::uint32_t i = 0; i < this->kept().size(); ++i) {
    const Bounds own = bounds_from(scene::bounds_of(this->kept()[i]));
    for (int trial = 0; trial < 30; ++trial) {
      Bounds cell = own;
      for (int k = 0; k < 3; ++k) {
        const float a = static_cast<float>(this->random_.between(own.lo[k], own.hi[k]));
        const float b = static_cast<float>(this->random_.between(own.lo[k], own.hi[k]));
        if (trial > 0) cell.lo[k] = std::min(a, b), cell.hi[k] = std::max(a, b);
      }
      const int axis = trial % 3;
      const auto at = static_cast<float>(this->random_.between(cell.lo[axis], cell.hi[axis]));
      const kdtree::SplitBounds parts =
          split(this->geometry_, kdtree::make_ref(TypeParam::kKind, i), cell, axis, at);
      for (int sample = 0; sample < 40; ++sample) {
        const RealPoint p = this->point(i);
        bool in_cell = true;
        for (int k = 0; k < 3; ++k) in_cell &= p[k] >= Real(cell.lo[k]) && p[k] <= Real(cell.hi[k]);
        if (!in_cell) continue;
        ++inside;
        ASSERT_TRUE(holds(box_from(p[axis] <= Real(at) ? parts.below : parts.above), p))
            << "number " << i << ", trial " << trial << ", seed " << kSeed;
      }
    }
  }
  EXPECT_GT(inside, 1000);
}

// Clipping is worth its time: by a cell of an eighth of the own box, the bounds become smaller more often
// than not, and some cells are found empty.
TYPED_TEST(GeometryOf, ClippingTightens) {
  int smaller = 0, empty = 0, n = 0;
  for (std::uint32_t i = 0; i < this->kept().size(); ++i) {
    const Bounds own = bounds_from(scene::bounds_of(this->kept()[i]));
    for (int corner = 0; corner < 8; ++corner, ++n) {
      Bounds cell = own;
      for (int k = 0; k < 3; ++k) {
        const float middle = 0.5f * own.lo[k] + 0.5f * own.hi[k];
        (corner >> k & 1 ? cell.lo : cell.hi)[k] =
            middle + (corner >> k & 1 ? 0.6f : -0.6f) * (own.hi[k] - middle);
      }
      const Bounds below =
          split(this->geometry_, kdtree::make_ref(TypeParam::kKind, i), cell, 0, cell.hi[0]).below;
      empty += below.empty() ? 1 : 0;
      smaller += below.empty() || box_from(below).area() < 0.95f * box_from(cell).area() ? 1 : 0;
    }
  }
  EXPECT_GT(empty, n / 20);
  EXPECT_GT(smaller, n / 3);
}

// One field of one shape at a time, by what the field means.
TYPED_TEST(GeometryOf, FaultsOfEachFieldAreRefused) {
  if constexpr (TypeParam::kIsShape) {
    using primitives::Meaning;
    const auto refuses = [&](const auto& field, double number) {
      scene::Scene s = this->scene_;
      auto& value = TypeParam::of(s)[7].*field.member;
      if constexpr (requires { value.x = number; })
        value = field.meaning == Meaning::direction ? dvec3(number) : dvec3(0, 0, number);
      else
        value = number;
      EXPECT_THROW(scene::check_scene(s), Error) << field.key << " " << number;
    };
    const auto refuses_faults = [&](const auto& field) {
      refuses(field, NAN), refuses(field, INFINITY);
      if (field.meaning == Meaning::direction || field.meaning == Meaning::above_zero) refuses(field, 0);
      if (field.meaning != Meaning::direction && field.meaning != Meaning::point) refuses(field, -1);
    };
    std::apply([&](const auto&... field) { (refuses_faults(field), ...); },
               fields_of(TypeParam::of(this->scene_).data()));
  }
}

// What is too small for a float beside the others is dropped, and counted.
TYPED_TEST(GeometryOf, DropsWhatVanishes) {
  if constexpr (TypeParam::kIsShape) {
    scene::Scene s = scene_of<TypeParam>(1, kSeed);
    scale_and_move(s, 1e-60, dvec3(0));
    Samples<TypeParam>::add(s, 0, this->random_);
    const scene::Geometry g = scene::make_geometry(s);
    EXPECT_EQ(g.dropped_degenerate, 1u);
    ASSERT_EQ(TypeParam::of(g).size(), 1u);
    EXPECT_EQ(TypeParam::of(g)[0].source, 1u);
  }
}

TYPED_TEST(GeometryOf, ItsMiddleIsWithinItsBounds) {
  if constexpr (TypeParam::kIsShape)
    for (const auto& shape : TypeParam::of(this->scene_)) {
      const DBox b = bounds_of(shape);
      const dvec3 middle = middle_of(shape), slack(1e-12);
      EXPECT_TRUE(glm::all(glm::lessThanEqual(b.lo - slack, middle)) &&
                  glm::all(glm::lessThanEqual(middle, b.hi + slack)));
    }
}

// A scene moved, turned and enlarged is the same to rays that are moved with it: its bounds follow.
TYPED_TEST(GeometryOf, MovesWithItsScene) {
  scene::Scene moved = this->scene_;
  const dmat4 m = scene::translation({3, -1, 2}) * scene::rotation(glm::normalize(dvec3(1, 2, 3)), 0.7) *
                  scene::scaling(dvec3(2));
  scene::apply_transform(m, moved);
  for (std::size_t i = 0; i < this->kept().size(); ++i)
    for (int sample = 0; sample < 10; ++sample) {
      const dvec3 world = this->geometry_.space.world(dvec3(this->point(i)));
      const dvec3 p(m * glm::dvec4(world, 1));
      const DBox b = moved.bounds();
      EXPECT_TRUE(glm::all(glm::lessThanEqual(b.lo - 1e-6, p)) &&
                  glm::all(glm::lessThanEqual(p, b.hi + 1e-6)));
    }
}

TYPED_TEST(GeometryOf, HasItsFeature) {
  const layout::Features mask = flatten::features_of(this->scene_, this->geometry_);
  EXPECT_EQ(mask & KDRAY_FEATURE_ALL_KINDS, KDRAY_FEATURE_OF_KIND(TypeParam::kNumber));
  const flatten::FeatureNames names = flatten::feature_names(mask);
  EXPECT_TRUE(std::find(names.on.begin(), names.on.end(), TypeParam::kNames) != names.on.end());
}

// Every leaf that holds a point of a primitive refers to it.
TYPED_TEST(GeometryOf, TheTreeFindsIt) {
  for (const kdtree::Quality quality :
       {kdtree::Quality::fast, kdtree::Quality::balanced, kdtree::Quality::best}) {
    kdtree::BuildConfig config;
    config.quality = quality;
    const kdtree::Tree tree = kdtree::build(this->geometry_, config);
    for (std::uint32_t i = 0; i < this->kept().size(); ++i) {
      const RealPoint p = this->point(i);
      bool found = false;
      for (std::uint32_t n = 0; n < tree.nodes.size() && !found; ++n) {
        const kdtree::Node& node = tree.nodes[n];
        if (!node.is_leaf() || !holds(tree.contents[n], p)) continue;
        for (std::uint32_t k = 0; k < node.right; ++k)
          found |= tree.refs[node.left + k] == kdtree::make_ref(TypeParam::kKind, i);
      }
      ASSERT_TRUE(found) << "number " << i << ", seed " << kSeed;
    }
  }
}

}  // namespace
}  // namespace kdray::test
