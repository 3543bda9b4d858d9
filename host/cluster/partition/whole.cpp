// What    A rank's share of a scene that every rank has read whole: for formats that can't be read otherwise.
// Memory  The scene's, until the share is taken.

#include "accel/flatten/features.h"
#include "accel/flatten/scene_hash.h"
#include "base/error.h"
#include "cluster/partition/share.h"

namespace kdray::partition {

namespace {

// A rank with another scene would give away a share of that.
void check_same(const scene::Scene& scene, const flatten::FlatScene& flat, transport::Together& all) {
  struct Seen {
    Hash hash;
    std::uint64_t same = 1;
  };
  const Seen all_have = all.join_values(Seen{flatten::scene_hash(flatten::hash_of_primitives(flat), flat)},
                                        [](Seen& sum, const Seen& one) {
                                          if (!(one.hash == sum.hash)) sum.same = 0;
                                        });
  if (all_have.same == 0)
    throw Error(ErrorCode::input,
                scene.name + ": is another scene for another rank; all of them need the same");
}

}  // namespace

Share share_of(const scene::Scene& scene, transport::Together& all) {
  if (!scene.instances.empty())
    throw Error(ErrorCode::usage,
                "a scene with instances can't be divided among ranks yet; take --mode pdprt for it");
  Share share;
  const scene::Geometry geometry = scene::make_geometry(scene);
  prepare::describe(share.whole, scene, geometry);
  share.whole.features = flatten::features_of(scene, geometry);
  share.whole.geometry.bounds = geometry.bounds;
  flatten::FlatScene flat = flatten::flatten(scene, geometry, kdtree::Tree(), false);
  check_same(scene, flat, all);
  add_slice(share.primitives, scene, geometry, flat, all.rank(), all.size());
  share.primitives.bare_zero_area.clear();  // they have their neighbours' normals, which are here
  flat.triangles = {}, flat.normals = {}, flat.corner_colors = {}, flat.texcoords = {};
  primitives::for_each_shape([&](auto kind) { decltype(kind)::of(flat) = {}; });
  share.whole.flat = std::move(flat);
  return share;
}

}  // namespace kdray::partition
