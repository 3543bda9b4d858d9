#include "bench/queries/kdray_side.h"

namespace kdray::bench {

namespace {

template <class T>
std::span<T> some(std::vector<T>& all, std::size_t first, std::size_t n, std::size_t values = 1) {
  return std::span(all).subspan(values * first, values * n);
}

Points points_of(const std::vector<float>& all, std::size_t first, std::size_t n) {
  return Points(all.data() + 3 * first, n);
}

class KdrayAsker : public Asker {
 public:
  explicit KdrayAsker(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {}

  void ask(Question question, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) override {
    const Rays rays{points_of(set.origins, first, n), points_of(set.directions, first, n)};
    const Points points = points_of(set.points, first, n);
    const auto words = [&](std::vector<std::uint32_t>& all) { return WordsOut(some(all, first, n)); };
    const auto values = [&](std::vector<float>& all) { return ValuesOut(some(all, first, n)); };
    switch (question) {
      case Question::closest:
        scene_->closest(rays, {.t = values(a.t),
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
        scene_->closest_points(points, {.distance = values(a.t),
                                        .point = some(a.point, first, n, 3),
                                        .geometry = words(a.geometry),
                                        .primitive = words(a.primitive),
                                        .u = values(a.u),
                                        .v = values(a.v)});
        break;
      case Question::distance:
        scene_->signed_distance(points, values(a.t));
        break;
      case Question::inside:
        scene_->inside(points, some(a.hit, first, n));
        break;
    }
  }

 private:
  std::shared_ptr<const Scene> scene_;
};

}  // namespace

Scene kdray_scene(const MeshArrays& mesh, const DeviceOptions& device) {
  Scene scene;
  scene.add_mesh({mesh.vertices, mesh.triangles});
  CommitOptions options;
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

}  // namespace kdray::bench
