#include "prepare/instanced.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "flatten/features.h"
#include "flatten/instance_tree.h"
#include "flatten/instances.h"
#include "flatten/paint.h"

namespace kdray::prepare {

namespace {

using flatten::FlatScene, flatten::WideForm;

// A mesh, flattened, and where its arrays begin among those of all.
struct Part {
  FlatScene flat;
  WideForm wide;
  flatten::MeshForm form;
};

// The array of all: of the scene, then of each mesh. change(value, part) for a mesh's values.
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

// Where each part's begin, of what size_of(part) counts, behind `first` of the scene's.
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

void join_normals_and_paint(FlatScene& flat, const std::vector<Part>& parts) {
  flat.normals = joined(
      flat.normals, parts, [](const Part& p) -> auto& { return p.flat.normals; }, kAsItIs);
  flat.texcoords = joined(
      flat.texcoords, parts, [](const Part& p) -> auto& { return p.flat.texcoords; }, kAsItIs);
  flat.corner_colors = joined(
      flat.corner_colors, parts, [](const Part& p) -> auto& { return p.flat.corner_colors; }, kAsItIs);
}

// Of each kind, where each part's primitives begin; and the primitives themselves.
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
        primitive.normals = (primitive.normals & KDRAY_STITCH) | static_cast<layout::u32>(mine + normals[i]);
    }
    return primitive;
  });
  check(Kind::of(flat).size(), KDRAY_REF_INDEX_MASK, Kind::kNames);
  return places;
}

// Blocks, whose last row names primitives; returns where each part's begin.
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
        // A lane that is empty has an index that is never used.
        indices[lane] = last | (static_cast<layout::u32>(index + primitives[i]) & KDRAY_REF_INDEX_MASK);
      }
    }
  });
  Kind::blocks_of(wide) = std::move(all);
  return places;
}

// A node whose children are elsewhere now: nodes and blocks behind others.
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

// The boxes of the root's children and their children, which cover all of the mesh.
std::vector<Box> parts_of(const WideForm& wide) {
  const auto boxes_of = [&](const layout::WideNode& node) {
    std::vector<std::pair<Box, layout::u32>> boxes;
    for (std::size_t slot = 0; slot < 8; ++slot) {
      Box box;
      for (int k = 0; k < 3; ++k) box.lo[k] = node.bounds[k][0][slot], box.hi[k] = node.bounds[k][1][slot];
      if (!box.empty()) boxes.emplace_back(box, node.child[slot]);
    }
    return boxes;
  };
  std::vector<Box> parts;
  for (const auto& [box, child] : boxes_of(wide.nodes[0])) {
    if (child & KDRAY_WIDE_LEAF) {
      parts.push_back(box);
      continue;
    }
    for (const auto& below : boxes_of(wide.nodes[child])) parts.push_back(below.first);
  }
  return parts;
}

// The scene's own nodes, the tree over the instances, and the meshes' trees, with a root above the first two.
class Nodes {
 public:
  Nodes(const WideForm& scene, bool is_empty, const flatten::InstanceTree& over, std::size_t n_over)
      : first_over_(is_empty ? 0 : 1 + scene.nodes.size()), first_mesh_(first_over_ + n_over) {
    if (!is_empty) {
      nodes_.emplace_back();
      for (const layout::WideNode& node : scene.nodes) nodes_.push_back(Shift{1, {}}(node));
    }
    for (const layout::WideNode& node : over.nodes) nodes_.push_back(Shift{first_over_, {}}(node));
  }

  std::size_t first_over() const { return first_over_; }
  std::size_t first_mesh() const { return first_mesh_; }
  void add(const WideForm& mesh, Shift shift) {
    shift.nodes = nodes_.size();
    for (const layout::WideNode& node : mesh.nodes) nodes_.push_back(shift(node));
  }
  RawVector<layout::WideNode>& all() { return nodes_; }

 private:
  std::size_t first_over_, first_mesh_;
  RawVector<layout::WideNode> nodes_;
};

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
  // A mesh that has nothing to be hit has no instances.
  std::vector<scene::Instance> instances;
  for (const scene::Instance& instance : scene_.instances)
    if (meshes_[instance.mesh].geometry.size() > 0) instances.push_back(instance);
  if (instances.empty()) return;
  check(instances.size(), KDRAY_WIDE_FIRST_MASK, "instances");
  const bool empty = made.wide.nodes.empty() || made.geometry.bounds.empty();

  std::vector<Part> parts(meshes_.size());
  int of_meshes = 0;  // what walks stack in them
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Part& part = parts[i];
    const Mesh& mesh = meshes_[i];
    part.flat = flatten::flatten(*scene_.meshes[i], mesh.geometry, mesh.tree, false);
    flatten::pack_corners_of(scene_.paint, *scene_.meshes[i], mesh.geometry, part.flat);
    part.wide = flatten::make_wide(mesh.tree, part.flat, made.wide.block);
    part.form = {mesh.geometry.space, mesh.tree.bounds, parts_of(part.wide), 0};
    made.features |= flatten::features_of_mesh(scene_, *scene_.meshes[i], mesh.geometry);
    of_meshes = std::max(of_meshes, part.wide.stack_size);
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
  join_normals_and_paint(made.flat, parts);

  // Where meshes' roots come to lie depends on the tree over the instances, and that on their bounds alone.
  std::vector<flatten::MeshForm> forms;
  for (Part& part : parts) forms.push_back(part.form);
  flatten::PlacedInstances placed = flatten::place_instances(instances, forms, made.geometry.space);
  const flatten::InstanceTree over = flatten::build_instance_tree(placed.bounds);
  Nodes nodes(made.wide, empty, over, over.nodes.size());
  std::vector<layout::u32> roots;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    roots.push_back(static_cast<layout::u32>(nodes.all().size()));
    nodes.add(parts[i].wide, shifts[i]);
  }
  for (std::size_t i = 0; i < instances.size(); ++i) placed.instances[i].root = roots[instances[i].mesh];
  if (!empty) {
    const Box boxes[] = {made.geometry.bounds, placed.all};
    const layout::u32 children[] = {1, static_cast<layout::u32>(nodes.first_over())};
    nodes.all()[0] = flatten::node_of(boxes, children);
  }
  check(nodes.all().size(), KDRAY_WIDE_NODE_MAX, "nodes");
  const int of_over = *std::max_element(over.needs.begin(), over.needs.end());
  // In a mesh a batch goes on with the same stack, behind an entry that leads out.
  made.wide.stack_size = std::max(made.wide.stack_size, of_over) + (empty ? 0 : 1) + 1 + of_meshes;
  made.wide.nodes = Array<layout::WideNode>::copy_of(nodes.all());
  made.wide.widen = placed.widen;
  made.flat.instances = std::move(placed.instances);
  made.geometry.bounds.grow(placed.all);
  made.counts.instances = instances.size();
  for (const scene::Instance& instance : instances)
    made.counts.instanced += meshes_[instance.mesh].geometry.size();
}

std::size_t largest_mesh(const scene::Scene& scene) {
  std::size_t most = 0;
  for (const auto& mesh : scene.meshes) most = std::max<std::size_t>(most, mesh->primitive_count());
  return most;
}

void refuse_instances(const Prepared& scene, const char* what) {
  if (!scene.flat.instances.empty())
    throw Error(
        ErrorCode::usage,
        fmt::format(
            "the scene has {} instances of meshes, which {} can't follow; load it with --instances flat",
            scene.flat.instances.size(), what));
}

}  // namespace kdray::prepare
