#include "bench/instances/bench.h"

#include <fmt/format.h>

#include <memory>

#include "bench/embree/embree.h"
#include "bench/race/compare.h"
#include "bench/race/race.h"
#include "bench/workload/scenes.h"
#include "scene/generate/built_in.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/model/instances.h"

namespace kdray::bench {

namespace {

constexpr std::size_t kBallTriangles = 75000;

InstancesOptions resolved(InstancesOptions o) {
  if (o.meshes.empty()) o.meshes = {"ball"};
  if (o.apart.empty()) o.apart = {1, 0.5, 0.25};
  if (o.classes.empty()) o.classes = {"primary", "shadow", "diffuse", "random"};
  if (o.traversals.empty())
    for (const std::string_view name : instance_traversals()) o.traversals.emplace_back(name);
  return o;
}

scene::Scene load_mesh(const std::string& name) {
  if (name != "ball") return load_scene(name);
  scene::Scene ball = generate::displaced_sphere_of(kBallTriangles);
  ball.name = name;
  return ball;
}

scene::Scene with_copies(scene::Scene model) {
  scene::flatten_instances(model);
  return model;
}

// A scene in one of the two forms, and who traces it.
struct Form {
  Scene scene;
  std::shared_ptr<Renderer> renderer;
  EmbreeScenes embree;

  Form(scene::Scene model, const InstancesOptions& o) : scene(std::move(model)) {
    const DeviceOptions device{.device = o.device, .compute_units = o.cores};
    renderer = std::make_shared<Renderer>(scene, TreeOptions{.binary_form = false}, device);
    if (o.embree) embree = make_embree_scenes(scene.model());
  }

  std::vector<Contestant> contestants(const InstancesOptions& o, int cores) const {
    std::vector<Contestant> all;
    for (const std::string& name : o.traversals) all.push_back(kdray_contestant(renderer, name));
    for (Contestant& c : embree_contestants(embree, cores)) all.push_back(std::move(c));
    return all;
  }

  std::vector<Hit> hits(const RayClass& c, const std::string& traversal) const {
    return renderer->trace(c.rays, c.any_hit, 1, traversal_of(traversal));
  }
  std::uint64_t bytes() const { return renderer->statistics().memory.scene_bytes; }
};

class Flock {
 public:
  Flock(const InstancesOptions& options, scene::Scene flock, double apart)
      : options_(options),
        instances_(std::move(flock), options),
        copies_(with_copies(instances_.scene.model()), options) {
    const scene::Scene& model = instances_.scene.model();
    run_ = {.mesh = model.name,
            .apart = apart,
            .n_instances = model.instances.size(),
            .n_triangles = model.meshes[0]->triangles.size(),
            .instances_bytes = instances_.bytes(),
            .copies_bytes = copies_.bytes(),
            .machine = machine_of(instances_.renderer->statistics()),
            .classes = {}};
  }

  InstancesRun run(const Working& working) {
    const std::vector<RayClass> classes = make_classes(
        copies_.scene.model(), options_.classes, side_of(options_.rays),
        [&](std::span<const Ray> rays) { return copies_.renderer->trace(rays, false, 1, Traversal::wide); });
    for (const RayClass& c : classes) {
      working(fmt::format("{}, {} apart: {}", run_.mesh, run_.apart, c.name));
      run_.classes.push_back(race_on(c));
    }
    return std::move(run_);
  }

 private:
  // Both forms' contestants take turns; each form's hits are held against those of its first walk.
  InstancesClass race_on(const RayClass& c) const {
    InstancesClass result{c.name, c.any_hit, c.rays.size(), 0, 0, {}};
    if (c.rays.empty()) return result;
    const std::string& first = options_.traversals.front();
    const std::vector<Hit> of_instances = instances_.hits(c, first), of_copies = copies_.hits(c, first);
    result.n_hits = count_hits(of_instances);
    result.differing_share = differing_distances(of_instances, of_copies);
    std::vector<Contestant> kept = instances_.contestants(options_, run_.machine.cores),
                            flat = copies_.contestants(options_, run_.machine.cores), all;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      kept[i].reference = of_instances, flat[i].reference = of_copies;
      all.push_back(std::move(kept[i]));
      all.push_back(std::move(flat[i]));
    }
    const std::vector<Outcome> outcomes = race(c, {}, all, options_.repeat);
    for (std::size_t i = 0; i < outcomes.size(); i += 2)
      result.pairs.push_back({outcomes[i], outcomes[i + 1]});
    return result;
  }

  const InstancesOptions& options_;
  Form instances_, copies_;
  InstancesRun run_;
};

}  // namespace

std::vector<std::string_view> instance_traversals() {
  std::vector<std::string_view> names;
  for (const std::string_view name : traversal_names())
    if (name != "binary") names.push_back(name);
  return names;
}

std::vector<InstancesRun> bench_instances(const InstancesOptions& options,
                                          const Progress<InstancesRun>& progress) {
  const InstancesOptions o = resolved(options);
  std::vector<InstancesRun> runs;
  for (const std::string& name : o.meshes) {
    const scene::Scene mesh = load_mesh(name);
    for (const double apart : o.apart) {
      scene::Scene flock = flock_of(mesh, o.across, apart);
      progress.working(fmt::format("{}, {} apart: building trees", name, apart));
      runs.push_back(Flock(o, std::move(flock), apart).run(progress.working));
      progress.done(runs.back());
    }
  }
  return runs;
}

std::size_t count_not_identical(std::span<const InstancesRun> runs) {
  return count_over(runs, [](const InstancesRun& run) {
    return count_over(run.classes, [](const InstancesClass& c) {
      return count_over(c.pairs, [](const Pair& p) { return p.n_not_identical(); });
    });
  });
}

double times_copies(const InstancesClass& c, Family family) {
  double instances = 0, copies = 0;
  for (const Pair& p : c.pairs) {
    if (p.instances.family != family) continue;
    if (instances == 0 || p.instances.seconds.median < instances) instances = p.instances.seconds.median;
    if (copies == 0 || p.copies.seconds.median < copies) copies = p.copies.seconds.median;
  }
  return copies > 0 ? instances / copies : 0;
}

}  // namespace kdray::bench
