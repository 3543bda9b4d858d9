#include "cluster/partition/share.h"

#include <algorithm>

#include "accel/flatten/features.h"
#include "accel/flatten/scene_hash.h"
#include "base/error.h"
#include "scene/model/geometry.h"

namespace kdray::partition {

namespace {

// Throws where the ranks' scenes differ: a rank with another scene would give away a share of that.
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

void Facts::add(const scene::Scene& scene, const scene::Geometry& geometry) {
  Facts part;
  part.dropped = geometry.dropped_degenerate;
  part.lost = geometry.lost;
  part.fine = geometry.fine;
  part.zero_area = geometry.zero_area.size();
  primitives::for_each_kind(
      [&](auto kind) { part.counts[kind.kNumber] = decltype(kind)::of(geometry).size(); });
  if (!geometry.triangles.empty())
    part.last_number = geometry.triangles[geometry.triangles.size() - 1].number;
  part.features = flatten::features_of(scene, geometry) & ~KDRAY_FEATURE_NUMBERS;
  part.bounds = geometry.bounds;
  add(part);
}

void Facts::add(const Facts& o) {
  dropped += o.dropped, lost += o.lost, fine += o.fine, zero_area += o.zero_area,
      shaded_flat += o.shaded_flat;
  for (std::size_t kind = 0; kind < counts.size(); ++kind) counts[kind] += o.counts[kind];
  last_number = std::max(last_number, o.last_number);
  features |= o.features;
  bounds.grow(o.bounds);
}

void tell(const Facts& facts, prepare::Prepared& whole) {
  const std::uint64_t kept = facts.counts[KDRAY_KIND_TRIANGLE];
  if (const auto warning = scene::range_warning(facts.lost, facts.fine, kept); !warning.empty())
    whole.settings.warnings.push_back(warning);
  whole.geometry.dropped_degenerate = static_cast<std::uint32_t>(facts.dropped);
  whole.geometry.bounds = facts.bounds;
  whole.counts.primitives = kept + facts.dropped;
  primitives::for_each_kind(
      [&](auto kind) { decltype(kind)::of(whole.counts) = facts.counts[kind.kNumber]; });
  whole.counts.zero_area = facts.zero_area;
  // Numbers ascend, so that they are the places of what is kept if the last one is.
  const bool numbers = kept > 0 && facts.last_number != kept - 1;
  const layout::Features mask = facts.features | (numbers ? KDRAY_FEATURE_NUMBERS : layout::Features{0});
  whole.features = flatten::features_in_light(mask, whole.settings);
}

}  // namespace kdray::partition
