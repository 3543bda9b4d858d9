#include "accel/prepare/instanced.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "accel/flatten/features.h"
#include "accel/flatten/instance_openings.h"
#include "accel/flatten/instances.h"
#include "accel/flatten/textures.h"
#include "base/error.h"
#include "base/timer.h"

namespace kdray::prepare {

namespace {

using flatten::FlatScene, flatten::WideForm;

// A mesh, flattened, and where its arrays begin among those of all.
struct Part {
  FlatScene flat;
  WideForm wide;
  flatten::MeshForm form;
};

// Returns one array: the scene's values, then each mesh's, as change(value, part) makes them.
template <class T, class ArrayOf, class Change>
Array<T> joined(const Array<T>& first, const std::vector<Part>& parts, const ArrayOf& array_of,
                const Change& change) {
  std::vector<std::size_t> places{first.size()};
  for (const Part& part : parts) places.push_back(places.back() + array_of(part).size());
  Array<T> all(places.back());
  std::copy(first.begin(), first.end(), all.begin());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    const auto& from = array_of(parts[i]);
    for (std::size_t k = 0; k < from.size(); ++k) all[places[i] + k] = change(from[k], i);
  });
  return all;
}

// Returns where each part's items begin, behind `first` of the scene's; size_of(part) counts them.
template <class SizeOf>
std::vector<std::size_t> places_behind(std::size_t first, const std::vector<Part>& parts,
                                       const SizeOf& size_of) {
  std::vector<std::size_t> places;
  for (const Part& part : parts) {
    places.push_back(first);
    first += size_of(part);
  }
  return places;
}

void check(std::size_t n, std::size_t most, const char* what) {
  if (n > most)
    throw Error(ErrorCode::input, fmt::format("the meshes of the scene have too many {}: {}", what, n));
}

constexpr auto kAsItIs = [](const auto& value, std::size_t) { return value; };

void join_normals_and_textures(FlatScene& flat, const std::vector<Part>& parts) {
  flat.normals = joined(
      flat.normals, parts, [](const Part& p) -> auto& { return p.flat.normals; }, kAsItIs);
  flat.texcoords = joined(
      flat.texcoords, parts, [](const Part& p) -> auto& { return p.flat.texcoords; }, kAsItIs);
  flat.corner_colors = joined(
      flat.corner_colors, parts, [](const Part& p) -> auto& { return p.flat.corner_colors; }, kAsItIs);
}

// Joins the primitives of a kind; returns where each part's begin.
template <class Kind>
std::vector<std::size_t> join_primitives(Kind, FlatScene& flat, const std::vector<Part>& parts,
                                         const std::vector<std::size_t>& normals) {
  const auto of = [](const Part& p) -> auto& {
    return Kind::of(p.flat);
  };
  const auto places =
      places_behind(Kind::of(flat).size(), parts, [&](const Part& p) { return of(p).size(); });
  Kind::of(flat) = joined(Kind::of(flat), parts, of, [&](auto primitive, std::size_t i) {
    if constexpr (!Kind::kIsShape) {
      const layout::u32 mine = primitive.normals & KDRAY_NORMALS_MASK;
      if (mine != KDRAY_NO_NORMALS)
        primitive.normals =
            (primitive.normals & KDRAY_ZERO_AREA) | static_cast<layout::u32>(mine + normals[i]);
    }
    return primitive;
  });
  check(Kind::of(flat).size(), KDRAY_REF_INDEX_MASK, Kind::kNames);
  return places;
}

// Joins blocks, whose last row names primitives; returns where each part's begin.
template <class Kind>
std::vector<std::size_t> join_blocks(Kind, WideForm& wide, const std::vector<Part>& parts,
                                     const std::vector<std::size_t>& primitives) {
  const std::size_t lanes = static_cast<std::size_t>(wide.block), words = Kind::kRows * lanes;
  const auto of = [](const Part& p) -> auto& {
    return Kind::blocks_of(p.wide);
  };
  const auto places = places_behind(Kind::blocks_of(wide).size() / words, parts,
                                    [&](const Part& p) { return of(p).size() / words; });
  Array<layout::u32> all = joined(Kind::blocks_of(wide), parts, of, kAsItIs);
  check(all.size() / words, KDRAY_WIDE_FIRST_MASK, "leaf blocks of one kind");
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    const std::size_t n = of(parts[i]).size() / words;
    for (std::size_t block = 0; block < n; ++block) {
      layout::u32* const indices = all.data() + (places[i] + block) * words + (Kind::kRows - 1) * lanes;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const layout::u32 last = indices[lane] & KDRAY_WIDE_LAST, index = indices[lane] & ~KDRAY_WIDE_LAST;
        // An empty lane has an index that is never used.
        indices[lane] = last | (static_cast<layout::u32>(index + primitives[i]) & KDRAY_REF_INDEX_MASK);
      }
    }
  });
  Kind::blocks_of(wide) = std::move(all);
  return places;
}

// Adapts the names of a node's children to nodes and blocks that have moved.
struct Shift {
  std::size_t nodes = 0;
  std::array<std::size_t, primitives::kKinds> blocks{};

  layout::WideNode operator()(layout::WideNode node) const {
    for (layout::u32& child : node.child) {
      if ((child & KDRAY_INSTANCE_LEAF) == KDRAY_INSTANCE_LEAF) continue;
      child += static_cast<layout::u32>(child & KDRAY_WIDE_LEAF ? blocks[flatten::leaf_kind(child)] : nodes);
    }
    return node;
  }
};

// Nodes of the scene's own tree, whose children have their final names, and of all meshes, whose children are
// named from `first` on.
struct Trees {
  std::span<const layout::WideNode> own, meshes;
  std::size_t first = 0;
};

void copy_nodes(std::span<const layout::WideNode> from, const Shift& shift, layout::WideNode* to) {
  constexpr std::size_t kGrain = 4096;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, from.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) to[i] = shift(from[i]);
  });
}

// The instances that can be hit, and their places in the scene's list.
struct Hittable {
  std::vector<scene::Instance> instances;
  std::vector<layout::u32> places;

  Hittable(const PageVector<scene::Instance>& all, const std::vector<std::size_t>& mesh_sizes) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (mesh_sizes[all[i].mesh] == 0) continue;
      instances.push_back(all[i]);
      places.push_back(static_cast<layout::u32>(i));
    }
    check(instances.size(), KDRAY_WIDE_FIRST_MASK, "instances");
  }
};

// Joins the scene's own nodes, the tree over the instances, and the meshes' trees, with a root above the
// first two.
Array<layout::WideNode> joined_nodes(const Trees& trees, const flatten::InstanceTree& over,
                                     std::span<const Box> boxes) {
  const std::size_t first_over = trees.own.empty() ? 0 : 1 + trees.own.size(),
                    first_mesh = first_over + over.nodes.size();
  check(first_mesh + trees.meshes.size(), KDRAY_WIDE_NODE_MAX, "nodes");
  Array<layout::WideNode> nodes(first_mesh + trees.meshes.size());
  if (!trees.own.empty()) {
    const layout::u32 children[] = {1, static_cast<layout::u32>(first_over)};
    nodes[0] = flatten::node_of(boxes, children);
    std::copy(trees.own.begin(), trees.own.end(), nodes.data() + 1);
  }
  copy_nodes(over.nodes, Shift{first_over, {}}, nodes.data() + first_over);
  // A sum may wrap around, as a child's number does where nodes move to the front.
  copy_nodes(trees.meshes, Shift{first_mesh - trees.first, {}}, nodes.data() + first_mesh);
  return nodes;
}

// Places the instances of `placed_meshes` and joins all nodes.
void place(Prepared& made, const Hittable& hittable, const Trees& trees) {
  const PlacedMeshes& meshes = *made.placed_meshes;
  flatten::PlacedInstances placed =
      flatten::place_instances(hittable.instances, meshes.meshes, made.geometry.space);
  const flatten::InstanceLeaves leaves =
      flatten::open_instances(placed, hittable.instances, meshes.meshes, made.geometry.space);
  const flatten::InstanceTree over = flatten::build_instance_tree(leaves.boxes, leaves.instances);
  const bool empty = trees.own.empty();
  const std::size_t first_mesh = (empty ? 0 : 1 + trees.own.size()) + over.nodes.size();
  const Box boxes[] = {meshes.own_bounds, placed.all};
  made.wide.nodes = joined_nodes(trees, over, boxes);
  made.counts.instances = hittable.instances.size();
  made.counts.instanced = 0;
  for (layout::Instance& instance : placed.instances) {
    instance.root += static_cast<layout::u32>(first_mesh);
    instance.number = hittable.places[instance.whole];
  }
  for (const scene::Instance& instance : hittable.instances)
    made.counts.instanced += meshes.sizes[instance.mesh];
  const int of_over = *std::max_element(over.needs.begin(), over.needs.end());
  // In a mesh a batch goes on with the same stack, behind an entry that leads out.
  made.wide.stack_size = std::max(meshes.own_stack, of_over) + (empty ? 0 : 1) + 1 + meshes.mesh_stack;
  made.wide.widen = placed.widen;
  made.flat.instances = std::move(placed.instances);
  made.geometry.bounds = meshes.own_bounds;
  made.geometry.bounds.grow(placed.all);
}

}  // namespace

Meshes::Meshes(const scene::Scene& scene, const kdtree::BuildConfig& config) : scene_(scene) {
  for (const auto& mesh : scene.meshes) {
    scene::Geometry geometry = scene::make_geometry(*mesh);
    kdtree::Tree tree = kdtree::build(geometry, config);
    meshes_.push_back({std::move(geometry), std::move(tree)});
  }
}

int Meshes::block(const kdtree::Tree& tree, std::size_t n_primitives) const {
  const kdtree::Tree* largest = &tree;
  for (const Mesh& mesh : meshes_)
    if (mesh.geometry.size() > n_primitives) n_primitives = mesh.geometry.size(), largest = &mesh.tree;
  return flatten::choose_block(*largest);
}

void Meshes::join(Prepared& made) const {
  std::vector<std::size_t> sizes;
  for (const Mesh& mesh : meshes_) sizes.push_back(mesh.geometry.size());
  const Hittable hittable(scene_.instances, sizes);
  if (hittable.instances.empty()) return;
  const bool empty = made.wide.nodes.empty() || made.geometry.bounds.empty();
  auto meshes = std::make_shared<PlacedMeshes>();
  meshes->sizes = std::move(sizes);
  meshes->own_bounds = made.geometry.bounds;
  meshes->own_stack = made.wide.stack_size;

  std::vector<Part> parts(meshes_.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Part& part = parts[i];
    const Mesh& mesh = meshes_[i];
    part.flat = flatten::flatten(*scene_.meshes[i], mesh.geometry, mesh.tree, false);
    flatten::pack_corners_of(scene_.texturing, *scene_.meshes[i], mesh.geometry, part.flat);
    part.wide = flatten::make_wide(mesh.tree, part.flat, made.wide.block);
    part.form = {mesh.geometry.space, mesh.tree.bounds, flatten::parts_of(part.wide)};
    made.features |= flatten::features_of_mesh(scene_, *scene_.meshes[i], mesh.geometry);
    meshes->mesh_stack = std::max(meshes->mesh_stack, part.wide.stack_size);
    made.geometry.dropped_degenerate += mesh.geometry.dropped_degenerate;
    made.tree_nodes += mesh.tree.nodes.size();
  }
  made.features |= flatten::features_of_instances(scene_);

  const auto normals =
      places_behind(made.flat.normals.size(), parts, [](const Part& p) { return p.flat.normals.size(); });
  std::vector<Shift> shifts(parts.size());
  primitives::for_each_kind([&](auto kind) {
    const auto places = join_primitives(kind, made.flat, parts, normals);
    const auto blocks = join_blocks(kind, made.wide, parts, places);
    for (std::size_t i = 0; i < parts.size(); ++i) shifts[i].blocks[kind.kNumber] = blocks[i];
  });
  join_normals_and_textures(made.flat, parts);

  // The places of meshes' roots depend on the tree over the instances.
  RawVector<layout::WideNode> own, of_meshes;
  if (!empty) {
    own.resize(made.wide.nodes.size());
    copy_nodes({made.wide.nodes.data(), own.size()}, Shift{1, {}}, own.data());
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Part& part = parts[i];
    shifts[i].nodes = of_meshes.size();
    const auto first = static_cast<layout::u32>(of_meshes.size());
    for (flatten::MeshPart& p : part.form.parts) p.root += first;
    of_meshes.resize(of_meshes.size() + part.wide.nodes.size());
    copy_nodes({part.wide.nodes.data(), part.wide.nodes.size()}, shifts[i], of_meshes.data() + first);
    meshes->meshes.push_back(std::move(part.form));
  }
  meshes->n_own_nodes = own.size();
  meshes->n_mesh_nodes = of_meshes.size();
  made.placed_meshes = std::move(meshes);
  place(made, hittable, {own, of_meshes, 0});
}

std::optional<Prepared> replace_instances(const scene::Scene& scene, const Prepared& last) {
  const Timer timer;
  if (!last.placed_meshes || scene.meshes.size() != last.placed_meshes->meshes.size() ||
      !(scene.materials == last.settings.materials) ||
      !scene::keeps_space(last.geometry.space, scene.bounds()))
    return std::nullopt;
  const PlacedMeshes& meshes = *last.placed_meshes;
  const Hittable hittable(scene.instances, meshes.sizes);
  if (hittable.instances.empty()) return std::nullopt;
  Prepared out = last;
  const std::vector<std::string> warnings = last.settings.warnings;
  out.settings = prepare::settings_of(scene);
  out.settings.warnings = warnings;
  out.features = flatten::features_in_light(last.features, scene);
  out.flat.lights = flatten::pack_lights(scene, last.geometry.space);
  out.flat.sky = {}, out.flat.sky_colors = {};
  flatten::pack_sky(scene.sky, out.flat);
  const std::span<const layout::WideNode> nodes(last.wide.nodes.data(), last.wide.nodes.size());
  const std::size_t first_mesh = nodes.size() - meshes.n_mesh_nodes;
  place(out, hittable,
        {nodes.subspan(meshes.n_own_nodes > 0 ? 1 : 0, meshes.n_own_nodes), nodes.subspan(first_mesh),
         first_mesh});
  out.seconds = {.load = last.seconds.load, .build = 0, .flatten = timer.seconds()};
  return out;
}

std::size_t largest_mesh(const scene::Scene& scene) {
  std::size_t most = 0;
  for (const auto& mesh : scene.meshes) most = std::max<std::size_t>(most, mesh->primitive_count());
  return most;
}

void refuse_instances(const Prepared& scene, const char* what) {
  if (!scene.flat.instances.empty())
    throw Error(ErrorCode::usage,
                fmt::format("the scene has {} instances of meshes, which {} can't follow; "
                            "load it with instances flat, add copies, or ask about it in double geometry",
                            scene.counts.instances, what));
}

}  // namespace kdray::prepare
