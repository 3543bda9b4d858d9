// What    A scene ready to be traced: all that a renderer keeps of it. The rest of the scene may go once it
//         is made.
// Shape   Plain values and arrays that a CPU device uses as they are; the scene cache (host/accel/cache)
//         keeps them in a file.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/flatten/flatten.h"
#include "accel/flatten/instances.h"
#include "accel/flatten/wide.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/statistics.h"
#include "kdray/options.h"
#include "layout/features.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::prepare {

// The names of the qualities that a tree is built with, as options, reports and statistics have them.

// The names come in the order of BuildQuality.
inline constexpr std::array<std::string_view, 3> kQualityNames = {"fast", "balanced", "best"};

constexpr std::string_view name_of(BuildQuality quality) {
  return kQualityNames[static_cast<std::size_t>(quality)];
}

struct Counts {
  std::uint64_t primitives = 0;  // of the file, degenerate ones too
  // That can be hit.
#define KDRAY_COUNT(NAME, name, names, Struct) std::uint64_t names = 0;
  KDRAY_KINDS(KDRAY_COUNT)
#undef KDRAY_COUNT
  std::uint64_t zero_area = 0;  // of the triangles, those without area (scene/model/zero_area.h)
  std::uint64_t instances = 0;  // of meshes
  std::uint64_t instanced = 0;  // primitives in all of them
};

// These are wall times.
struct Seconds {
  double load = 0, build = 0, flatten = 0;
  double total() const { return load + build + flatten; }
};

// What placing instances anew needs to know of their meshes (prepare/instanced.h).
struct PlacedMeshes {
  std::vector<flatten::MeshForm> meshes;  // roots are counted from the first mesh's first node
  std::vector<std::size_t> sizes;         // of each, primitives that can be hit
  Box own_bounds;                         // of the scene without its instances
  int own_stack = 0, mesh_stack = 0;      // what walks stack in the scene's own tree, and in meshes
  std::size_t n_own_nodes = 0, n_mesh_nodes = 0;
};

struct Prepared {
  scene::Scene settings;     // the scene but for its primitives, vertices and normals
  scene::Geometry geometry;  // centre and bounds (the root's cell: what rays are clipped to); no primitives
  Counts counts;
  layout::Features features = 0;
  int tree_depth = 0;  // of the deepest leaf: it sizes the kernels' stacks
  std::uint64_t tree_nodes = 0;
  kdtree::Statistics tree;
  flatten::FlatScene flat;
  flatten::WideForm wide;
  std::shared_ptr<const scene::DoubleGeometry> doubles;  // where they were asked for; not kept in files
  std::shared_ptr<const PlacedMeshes> placed_meshes;     // where there are instances; not kept in files
  TreeOptions tree_options;                              // that it was made with
  Seconds seconds;                                       // that it took to make

  std::size_t bytes() const { return flat.bytes() + wide.bytes(); }
  std::size_t largest_array() const;  // what a device has to hold in one piece
};

// Returns what the tree of a scene of n primitives is built with.
kdtree::BuildConfig config_of(const TreeOptions& options, std::size_t n_primitives);

// Returns whether questions about the scene are answered in doubles. `space`: the one that its floats would
// be in; else its own.
bool answers_in_doubles(const scene::Scene& scene, VertexPrecision geometry,
                        const std::optional<LocalSpace>& space = {});

// Prepares a scene. `kept`: the space that it had before it moved (scene::make_geometry).
Prepared prepare(const scene::Scene& scene, const TreeOptions& options,
                 const std::optional<LocalSpace>& kept = {});

// Does the same with a tree of any kind, for the scene's `geometry`. Leaves tree_options at their defaults.
Prepared prepare(const scene::Scene& scene, const scene::Geometry& geometry,
                 const kdtree::BuildConfig& config, bool binary_form = true);

// Returns a scene without its primitives, vertices and normals.
scene::Scene settings_of(const scene::Scene& scene);

// Writes what has nothing to do with the tree: settings, counts, warnings, and of the geometry all but its
// bounds.
void describe(Prepared& made, const scene::Scene& scene, const scene::Geometry& geometry);

// The warning of make_within(), and its error.
std::string warning_of_coarser(std::uint64_t bytes, std::uint64_t most_bytes);
[[noreturn]] void refuse_size(std::uint64_t least_bytes, std::uint64_t most_bytes);

// Builds by `make`, with ever coarser trees, until what a device gets of the scene fits a number of bytes
// (--memory): dearer inner nodes make larger leaves, so that there are fewer nodes, and fewer copies of
// primitives that lie in several. What `make` returns for a config has bytes(). `warning` becomes that the
// tree is coarser than asked for, and is left alone where it isn't. Throws ErrorCode::out_of_memory, with the
// least that the scene takes, where no tree fits.
template <class Make>
auto make_within(kdtree::BuildConfig config, std::uint64_t most_bytes, Make&& make, std::string& warning) {
  constexpr double kCoarsest = 256;
  config.cost_traverse = std::max(config.cost_traverse, 1.0);
  const double asked = config.cost_traverse, finest = config.group_traverse;
  for (double coarser = 1;; coarser *= 2) {
    config.cost_traverse = asked * coarser;
    config.group_traverse = finest * coarser;
    auto made = make(config);
    if (made.bytes() <= most_bytes) {
      if (coarser > 1) warning = warning_of_coarser(made.bytes(), most_bytes);
      return made;
    }
    if (coarser >= kCoarsest) refuse_size(made.bytes(), most_bytes);
  }
}

}  // namespace kdray::prepare
