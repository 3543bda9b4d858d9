// What    kdray as a side of `bench queries` (queries/bench.h).
#include <optional>

#include "bench/queries/bench.h"

namespace kdray::bench {

namespace {

template <class T>
std::span<T> some(std::vector<T>& all, std::size_t first, std::size_t n, std::size_t values = 1) {
  return std::span(all).subspan(values * first, values * n);
}

template <class Real>
Points points_of(const std::vector<Real>& all, std::size_t first, std::size_t n) {
  return Points(all.data() + 3 * first, n);
}

// A set's values in doubles, as a caller has them who wants doubles.
struct DoubleSet {
  explicit DoubleSet(const QuerySet& set)
      : of(&set),
        origins(set.origins.begin(), set.origins.end()),
        directions(set.directions.begin(), set.directions.end()),
        points(set.points.begin(), set.points.end()) {}

  const QuerySet* of;
  std::vector<double> origins, directions, points;
};

// Asks in floats, or in doubles.
class KdrayAsker : public Asker {
 public:
  explicit KdrayAsker(std::shared_ptr<const Scene> scene, bool in_double = false)
      : scene_(std::move(scene)), in_double_(in_double) {}

  void ask(Question question, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) override {
    if (!in_double_) return ask(question, set, first, n, a, a.t);
    if (!doubles_ || doubles_->of != &set) doubles_.emplace(set);
    a.in_double = true;
    ask(question, *doubles_, first, n, a, a.double_t);
  }

 private:
  template <class Set, class Real>
  void ask(Question question, const Set& set, std::size_t first, std::size_t n, Answers& a,
           std::vector<Real>& t) {
    const Rays rays{points_of(set.origins, first, n), points_of(set.directions, first, n)};
    const Points points = points_of(set.points, first, n);
    const auto words = [&](std::vector<std::uint32_t>& all) { return WordsOut(some(all, first, n)); };
    const auto values = [&](auto& all) { return ValuesOut(some(all, first, n)); };
    switch (question) {
      case Question::closest:
        scene_->closest(rays, {.t = values(t),
                               .geometry = words(a.geometry),
                               .primitive = words(a.primitive),
                               .u = values(a.u),
                               .v = values(a.v)});
        break;
      case Question::any:
        scene_->any(rays, some(a.hit, first, n));
        break;
      case Question::count:
        scene_->count(rays, words(a.count));
        break;
      case Question::all:
        a.all = scene_->all(rays);
        break;
      case Question::points:
        scene_->closest_points(points, {.distance = values(t),
                                        .point = some(a.point, first, n, 3),
                                        .geometry = words(a.geometry),
                                        .primitive = words(a.primitive),
                                        .u = values(a.u),
                                        .v = values(a.v)});
        break;
      case Question::distance:
        scene_->signed_distance(points, values(t));
        break;
      case Question::inside:
        scene_->inside(points, some(a.hit, first, n));
        break;
    }
  }

  std::shared_ptr<const Scene> scene_;
  bool in_double_;
  std::optional<DoubleSet> doubles_;  // of the set that was asked last
};

}  // namespace

Scene kdray_scene(const MeshArrays& mesh, const DeviceOptions& device, VertexPrecision geometry) {
  Scene scene;
  scene.add_mesh({mesh.vertices, mesh.triangles});
  CommitOptions options;
  options.tree.geometry = geometry;
  options.device = device;
  options.device.remember_programs = true;
  scene.commit(options);
  return scene;
}

Side kdray_side(const std::shared_ptr<const Scene>& scene, const MeshArrays& mesh,
                const DeviceOptions& device) {
  return {"kdray", {{"", std::make_shared<KdrayAsker>(scene)}}, [&mesh, device](const QuerySet& set) {
            Answers answer(Question::closest, 1);
            KdrayAsker(std::make_shared<const Scene>(kdray_scene(mesh, device)))
                .ask(Question::closest, set, 0, 1, answer);
          }};
}

Side double_side(const MeshArrays& mesh, const DeviceOptions& device) {
  const auto make = [&mesh, device] {
    return std::make_shared<const Scene>(kdray_scene(mesh, device, VertexPrecision::float64));
  };
  return {"double", {{"", std::make_shared<KdrayAsker>(make(), true)}}, [make](const QuerySet& set) {
            Answers answer(Question::closest, set.size());
            KdrayAsker(make(), true).ask(Question::closest, set, 0, 1, answer);
          }};
}

}  // namespace kdray::bench
