#include "cluster/partition/scene_partition.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "accel/flatten/scene_hash.h"
#include "accel/kdtree/build.h"
#include "accel/prepare/prepared.h"
#include "base/timer.h"
#include "cluster/partition/primitive_set.h"
#include "cluster/partition/share.h"
#include "scene/import/load.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::partition {

namespace {

// Copied, and let go of.
template <class T>
Array<T> array_of(RawVector<T>& values) {
  Array<T> array = Array<T>::copy_of(values);
  values = {};
  return array;
}

// Into the arrays of a scene whose other arrays are there. Returns what the tree is built of.
scene::Geometry unpack(PrimitiveSet set, const LocalSpace& space, flatten::FlatScene& flat) {
  scene::Geometry geometry;
  geometry.space = space;
  flat.triangles = array_of(set.triangles);
  geometry.triangles = flat.triangles;
  flat.normals = array_of(set.normals);
  flat.corner_colors = array_of(set.colors);
  flat.texcoords = array_of(set.texcoords);
  primitives::for_each_shape([&](auto kind) {
    using Kind = decltype(kind);
    auto& arrived = Kind::of(set);
    Kind::of(flat) = Array<typename Kind::Layout>(arrived.size());
    for (std::uint32_t i = 0; i < arrived.size(); ++i) {
      typename Kind::Geometry shape = arrived[i].shape;
      shape.source = i;
      Kind::of(geometry).push_back(shape);
      typename Kind::Layout packed = pack(shape);
      packed.number = arrived[i].number;
      packed.material = arrived[i].material;
      Kind::of(flat)[i] = packed;
    }
  });
  return geometry;
}

std::vector<std::uint32_t> ranks_of_primitives(const Cells& cells, std::span<const std::uint32_t> rank_of) {
  std::vector<std::uint32_t> ranks;
  ranks.reserve(cells.cell_of.size());
  for (const std::uint32_t cell : cells.cell_of) ranks.push_back(rank_of[cell]);
  return ranks;
}

std::size_t count_of_maps_with_colors(const scene::Scene& settings) {
  return static_cast<std::size_t>(std::ranges::count_if(
      settings.texturing.material_maps, [](const scene::MaterialMaps& c) { return c.colored != 0; }));
}

// CornerRows that triangles have.
CornerRows rows_of(const prepare::Prepared& whole) {
  CornerRows rows;
  rows.colors = count_of_maps_with_colors(whole.settings) > 0 ? 1 : 0;
  if (!whole.flat.textures.empty()) rows.texcoords = KDRAY_TEXTURE_SETS(whole.flat.textures[0].how);
  return rows;
}

class Builder {
 public:
  Builder(prepare::Prepared whole, const TreeOptions& options, transport::Together& all)
      : made_(std::move(whole)), options_(options), all_(all) {
    options_.binary_form = false;  // what ODPRT divides is the wide form
  }

  prepare::Prepared build(PrimitiveSet set) {
    const Timer timer;
    const scene::Geometry geometry = unpack(std::move(set), made_.geometry.space, made_.flat);
    // The settings of the whole scene's tree.
    const std::uint64_t n = primitives_in(made_.counts);
    const kdtree::BuildConfig config = prepare::config_of(options_, n);
    made_.tree_options = options_;
    options_.memory_bytes > 0 ? build_within(geometry, config) : build_tree(geometry, config);
    agree();
    made_.seconds.build += timer.seconds();
    return std::move(made_);
  }

 private:
  static std::uint64_t primitives_in(const prepare::Counts& counts) {
    std::uint64_t n = 0;
    primitives::for_each_kind([&](auto kind) { n += decltype(kind)::of(counts); });
    return n;
  }

  void build_tree(const scene::Geometry& geometry, const kdtree::BuildConfig& config) {
    const kdtree::Tree tree = kdtree::build(geometry, config);
    const flatten::Lanes lanes = all_.join_values(
        flatten::count_lanes(tree),
        [](flatten::Lanes& sum, const flatten::Lanes& one) { sum.of4 += one.of4, sum.of8 += one.of8; });
    flatten_tree(geometry, config, tree, flatten::choose_block(lanes));
  }

  void flatten_tree(const scene::Geometry& geometry, const kdtree::BuildConfig& config,
                    const kdtree::Tree& tree, int block) {
    made_.wide = flatten::make_wide(tree, made_.flat, block);
    made_.tree_depth = tree.max_depth;
    made_.tree_nodes = tree.nodes.size();
    made_.tree = kdtree::measure(tree, geometry, config);
  }

  // Each rank finds the tree that fits it; blocks are then of the size that the settings are for.
  void build_within(const scene::Geometry& geometry, const kdtree::BuildConfig& config) {
    std::string warning;
    const auto fitting = [&](const kdtree::BuildConfig& coarser) -> prepare::Prepared& {
      flatten_tree(geometry, coarser, kdtree::build(geometry, coarser), config.block == 8 ? 8 : 4);
      return made_;
    };
    struct Size {
      std::size_t size;
      std::size_t bytes() const { return size; }
    };
    prepare::make_within(
        config, options_.memory_bytes,
        [&](const kdtree::BuildConfig& coarser) { return Size{fitting(coarser).bytes()}; }, warning);
    if (!warning.empty()) made_.settings.warnings.push_back(warning);
  }

  void agree() {
    made_.tree_nodes = all_.sum(made_.tree_nodes);
    made_.tree_depth = all_.most(made_.tree_depth);
    made_.wide.stack_size = all_.most(made_.wide.stack_size);
  }

  prepare::Prepared made_;
  TreeOptions options_;
  transport::Together& all_;
};

flatten::Core core_of_all(const flatten::FlatScene& flat, transport::Together& all) {
  const Box bounds =
      all.join_values(flatten::triangle_bounds(flat), [](Box& sum, const Box& one) { sum.grow(one); });
  const flatten::Sides sides = all.join_values(
      flatten::sides_of(flat, bounds), [](flatten::Sides& sum, const flatten::Sides& one) { sum.grow(one); });
  return flatten::core_of(bounds, sides);
}

ScenePartition partition_share(Share share, const TreeOptions& tree, transport::Together& all) {
  ScenePartition result;
  Cells cells =
      divide_into_cells(share.primitives, cells_for(all.sum<std::uint64_t>(share.primitives.size())), all);
  result.rank_of = assign_cells(cells.cells, all.size());
  const std::vector<std::uint32_t> ranks = ranks_of_primitives(cells, result.rank_of);
  result.cells = std::move(cells.cells);
  cells = {};
  PrimitiveSet own = bring(std::move(share.primitives), ranks, rows_of(share.whole), all);
  result.prepared = Builder(std::move(share.whole), tree, all).build(std::move(own));
  result.core = core_of_all(result.prepared.flat, all);
  result.primitives = all.join_values(flatten::hash_of_primitives(result.prepared.flat),
                                      [](Hash& sum, const Hash& one) { flatten::add(sum, one); });
  return result;
}

}  // namespace

std::optional<ScenePartition> partition_scene(const std::filesystem::path& file, const LoadOptions& load,
                                              const TreeOptions& tree, transport::Together& all,
                                              const std::function<void(const scene::Scene&)>& check) {
  const Timer timer;
  std::optional<Share> share = read_in_shares(file, load, all);
  if (!share) {
    const scene::Scene whole = scene::load(file, load);
    if (all.any(!whole.instances.empty())) return std::nullopt;
    share = share_of(whole, all);
  }
  if (check) check(share->whole.settings);
  ScenePartition result = partition_share(std::move(*share), tree, all);
  // Waiting for others, too.
  result.prepared.seconds.load = timer.seconds() - result.prepared.seconds.build;
  return result;
}

ScenePartition partition_scene(const scene::Scene& scene, const TreeOptions& tree, transport::Together& all) {
  return partition_share(share_of(scene, all), tree, all);
}

}  // namespace kdray::partition
