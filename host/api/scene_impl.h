// What    What a Scene keeps: the file that it is of and the geometries that were added, what has changed
//         since the last commit(), and what was committed.
// Shape   scene.cpp has the interface, scene_commit.cpp makes the model and commits it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <vector>

#include "accel/prepare/refit.h"
#include "api/committed.h"
#include "kdray/kdray.h"
#include "scene/model/added_geometry.h"
#include "scene/model/scene.h"

namespace kdray {

struct Scene::Impl {
  scene::Scene base;                 // of the file; or nothing
  std::optional<GeometryInfo> file;  // geometry 0 as it is; none: there is no file, or it was removed
  GeometryId first_added = 0;        // 1 where there is a file, or was one
  double load_seconds = 0;
  std::vector<std::optional<scene::AddedGeometry>> geometries;  // by id, after the file's; none: removed
  std::vector<scene::Material> materials;
  scene::Texturing texturing;  // of these materials

  // Since the last commit(). Masks don't count.
  struct Changes {
    bool any = false;
    bool geometries = false;  // others than before; not only other vertices or another look
    bool vertices = false;    // not only other transforms or another look
  };
  Changes changes;

  // Of prototypes, by their ids, the meshes that their instances are of: as they are in `assembled`.
  struct Prototype {
    std::uint32_t first_material;
    std::shared_ptr<const scene::Scene> mesh;
  };
  std::map<GeometryId, Prototype> prototypes;

  mutable std::optional<scene::Scene> assembled;  // base and geometries together, where there are some
  bool is_stale = false;                          // something has changed since `assembled` was made

  std::unique_ptr<const prepare::Fitting> fitting;  // of the tree as it was built, once it was refitted
  double growth = 1;          // of what a ray is expected to cost, from then to what is committed
  bool has_replaced = false;  // by the last commit(): instances alone were elsewhere

  std::shared_mutex naming;  // of what hits are named by: geometries, which come and go, and their materials
  std::mutex mutex;          // of `committed`
  std::shared_ptr<api::Committed> committed;

  bool is_file(GeometryId id) const { return file && id == 0; }
  scene::AddedGeometry& added(GeometryId id);
  GeometryId add(scene::AddedGeometry&& geometry, const GeometryOptions& options);
  GeometryId put(scene::AddedGeometry&& geometry);
  const scene::AddedGeometry& prototype(GeometryId id);
  bool has_instances(GeometryId prototype) const;
  bool is_seen(const scene::AddedGeometry& instances) const;
  query::GeometryTable table() const;
  std::vector<Part> parts_of(GeometryId id, std::vector<scene::NameRun> scene::Names::*runs);
  void note_change();
  void note_other_geometries();

  const scene::Scene& model();
  CommitReport commit(CommitOptions options);
  std::shared_ptr<api::Committed> last();   // that was committed
  std::shared_ptr<api::Committed> asked();  // of the device, too

 private:
  scene::Scene begin_model(bool has_moved) const;
  const std::shared_ptr<const scene::Scene>& mesh_of(GeometryId prototype, std::uint32_t first_material);
  void put_instances(scene::Scene& all, std::uint32_t first_material);
  std::optional<PreparedScene> replace_instances(CommitReport& report);
  std::optional<PreparedScene> refit(const CommitOptions& options, CommitReport& report);
  PreparedScene build(const CommitOptions& options);
  void settle(const CommitReport& report);
};

}  // namespace kdray
