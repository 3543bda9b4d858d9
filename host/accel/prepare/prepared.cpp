#include "accel/prepare/prepared.h"

#include <fmt/format.h>

#include <algorithm>

#include "accel/flatten/features.h"
#include "accel/prepare/instanced.h"
#include "base/error.h"
#include "base/timer.h"

namespace kdray::prepare {

namespace {

kdtree::Quality quality_of(BuildQuality quality) {
  switch (quality) {
    case BuildQuality::fast:
      return kdtree::Quality::fast;
    case BuildQuality::best:
      return kdtree::Quality::best;
    default:
      return kdtree::Quality::balanced;
  }
}

}  // namespace

kdtree::BuildConfig config_of(const TreeOptions& o, std::size_t n_primitives) {
  kdtree::BuildConfig config;
  config.small_cells = o.binary_form.value_or(true);
  config.quality = quality_of(o.quality);
  config.max_depth = o.max_depth;
  config.cost_traverse = o.cost_traverse;
  config.cost_intersect = o.cost_intersect;
  return kdtree::suited(config, n_primitives);
}

// The scene is taken apart into all its members, so that one that is added can't be forgotten.
#define KDRAY_NO_SHAPES(NAME, name, names, Struct) .names = {},
scene::Scene settings_of(const scene::Scene& scene) {
  const auto& [name, vertices, normals, triangles, KDRAY_SHAPES(KDRAY_KIND_PLURAL) meshes, instances,
               materials, texturing, lights, unlit, camera, cameras, framing, background, sky, ambient,
               settings, warnings, files, load_options, names] = scene;
  scene::Sky without_picture = sky;
  without_picture.picture.reset();
  return {.name = name,
          .vertices = {},
          .normals = {},
          .triangles = {},
          KDRAY_SHAPES(KDRAY_NO_SHAPES).meshes = {},
          .instances = {},
          .materials = materials,
          .texturing = {.material_maps = texturing.material_maps},
          .lights = lights,
          .unlit = unlit,
          .camera = camera,
          .cameras = cameras,
          .framing = framing,
          .background = background,
          .sky = without_picture,
          .ambient = ambient,
          .settings = settings,
          .warnings = warnings,
          .files = files,
          .load_options = load_options,
          .names = names};
}
#undef KDRAY_NO_SHAPES

namespace {

// As --memory takes them.
std::string in_option(std::uint64_t bytes) {
  const bool is_small = bytes < 1 << 20;
  return fmt::format("{:.1f}{}", static_cast<double>(bytes) / (is_small ? 1 << 10 : 1 << 20),
                     is_small ? "K" : "M");
}

Prepared prepare_within(const scene::Scene& scene, const scene::Geometry& geometry,
                        const kdtree::BuildConfig& config, bool binary_form, std::uint64_t most_bytes) {
  std::string warning;
  Prepared made = make_within(
      config, most_bytes,
      [&](const kdtree::BuildConfig& coarser) { return prepare(scene, geometry, coarser, binary_form); },
      warning);
  if (!warning.empty()) made.settings.warnings.push_back(warning);
  return made;
}

}  // namespace

std::string warning_of_coarser(std::uint64_t bytes, std::uint64_t most_bytes) {
  return fmt::format("the tree is coarser, so that the scene takes {}, of {} that it may: tracing is slower",
                     in_option(bytes), in_option(most_bytes));
}

void refuse_size(std::uint64_t least_bytes, std::uint64_t most_bytes) {
  throw Error(ErrorCode::out_of_memory,
              fmt::format("the scene takes {} at least; a memory of {} is too little for it",
                          in_option(least_bytes), in_option(most_bytes)));
}

std::size_t Prepared::largest_array() const {
  std::size_t largest = 0;
  const auto look_at = [&](const auto& array) { largest = std::max(largest, array.bytes()); };
  flatten::for_each_flat_array(flat, look_at);
  flatten::for_each_wide_array(wide, look_at);
  return largest;
}

namespace {

bool has_shapes(const scene::Scene& scene) {
  return scene.primitive_count() != scene.triangles.size();
}

Prepared prepare_as(const TreeOptions& options, const scene::Scene& scene, const scene::Geometry& geometry) {
  const kdtree::BuildConfig config = config_of(options, std::max(geometry.size(), largest_mesh(scene)));
  const bool binary_form = options.binary_form.value_or(true);
  return options.memory_bytes > 0 ? prepare_within(scene, geometry, config, binary_form, options.memory_bytes)
                                  : prepare(scene, geometry, config, binary_form);
}

Prepared prepare_copied(const scene::Scene& scene, scene::Copies copies, const TreeOptions& options) {
  const scene::Geometry geometry = scene::make_geometry_for_doubles(scene);
  Prepared made = prepare_as(options, scene, geometry);
  auto doubles = std::make_shared<scene::DoubleGeometry>(scene::make_double_geometry(scene, geometry));
  doubles->copies = std::move(copies);
  made.doubles = std::move(doubles);
  return made;
}

// The scene's instances become copies: a vertex is where its transform brings it in doubles.
Prepared prepare_in_doubles(const scene::Scene& scene, const TreeOptions& options) {
  if (scene.instances.empty()) return prepare_copied(scene, {}, options);
  scene::Scene copied = scene;
  scene::Copies copies = scene::flatten_instances(copied);
  return prepare_copied(copied, std::move(copies), options);
}

}  // namespace

bool answers_in_doubles(const scene::Scene& scene, VertexPrecision geometry,
                        const std::optional<LocalSpace>& space) {
  if (geometry != VertexPrecision::automatic) return geometry == VertexPrecision::float64;
  return !has_shapes(scene) && scene.instances.empty() &&
         !scene::fits_floats(scene, space ? *space : scene::space_of(scene.bounds(), scene.name));
}

Prepared prepare(const scene::Scene& scene, const TreeOptions& options,
                 const std::optional<LocalSpace>& kept) {
  const Timer timer;
  const bool is_automatic = options.geometry == VertexPrecision::automatic;
  const bool in_doubles = answers_in_doubles(scene, options.geometry);
  Prepared made = in_doubles ? prepare_in_doubles(scene, options)
                             : prepare_as(options, scene,
                                          scene::make_geometry(scene, is_automatic ? std::nullopt : kept));
  if (in_doubles && is_automatic)
    made.settings.warnings.push_back(
        "the scene's vertices are no floats: questions are answered in doubles, which takes longer");
  made.tree_options = options;
  made.seconds.build = timer.seconds() - made.seconds.flatten;
  return made;
}

void describe(Prepared& made, const scene::Scene& scene, const scene::Geometry& geometry) {
  made.settings = prepare::settings_of(scene);
  made.geometry.space = geometry.space;
  made.geometry.dropped_degenerate = geometry.dropped_degenerate;
  if (const std::string warning = scene::range_warning(geometry); !warning.empty())
    made.settings.warnings.push_back(warning);
  made.counts.primitives = scene.primitive_count();
  primitives::for_each_kind(
      [&](auto kind) { decltype(kind)::of(made.counts) = decltype(kind)::of(geometry).size(); });
  made.counts.zero_area = geometry.zero_area.size();
}

Prepared prepare(const scene::Scene& scene, const scene::Geometry& geometry,
                 const kdtree::BuildConfig& config, bool binary_form) {
  Prepared made;
  describe(made, scene, geometry);
  made.features = flatten::features_of(scene, geometry);

  Timer step;
  const kdtree::Tree tree = kdtree::build(geometry, config);
  const Meshes meshes(scene, config);
  made.seconds.build = step.seconds();

  step.restart();
  made.flat = flatten::flatten(scene, geometry, tree, binary_form && scene.instances.empty());
  made.wide = flatten::make_wide(tree, made.flat, meshes.block(tree, geometry.size()));
  made.geometry.bounds = tree.bounds;
  made.tree_depth = tree.max_depth;
  made.tree_nodes = tree.nodes.size();
  meshes.join(made);
  made.seconds.flatten = step.seconds();

  made.tree = kdtree::measure(tree, geometry, config);
  return made;
}

}  // namespace kdray::prepare
