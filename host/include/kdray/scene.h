// What    A scene: read from a file, or made of a program's own arrays; and, once it is committed, what can
//         be asked of it: hits, crossings, closest points, what is inside, pictures.
// Shape   A Scene is the program's description; commit() turns it into what queries see. Until the
//         next commit() queries go on over what was committed, whatever is added, moved or removed
//         meanwhile.
// Errors  Everything throws kdray::Error, and std::bad_alloc where the process has no memory left. An array
//         that is wrong is ErrorCode::input, and the message names the array and the element; nothing of the
//         scene has changed then.
// Threads One thread at a time adds, changes, lists and commits. Any number may ask, also meanwhile: they are
//         answered from the state before until commit() returns; name_of() and material_of() know what is
//         there by now. Nobody may ask what is destroyed meanwhile; what was moved from may be assigned to or
//         destroyed, and nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kdray/error.h"
#include "kdray/model.h"
#include "kdray/options.h"
#include "kdray/query.h"

namespace kdray {

// For kdray's own modules.
namespace scene {
struct Scene;
}
namespace prepare {
struct Prepared;
}
class PreparedScene;
struct Picture;

// The most memory, in bytes, that this process takes for the texels of pictures that come from now on. What
// is more lies in files without names, in $TMPDIR or else /var/tmp, of which the system holds in memory what
// is looked at (docs/design/textures.md). The picture is the same. Where none is set: half of the memory that
// is free. Loading or committing then throws ErrorCode::input when there is no room for a file.
void set_texture_cache(std::uint64_t bytes);

struct CommitOptions {
  TreeOptions tree = {};
  DeviceOptions device = {};
  // Where only vertices have moved, the tree is fitted to them unless what a ray is expected to cost has
  // grown by more than this since it was built. 0: it is always built anew (docs/embed.md).
  double refit_growth = 1.5;
};

struct CommitReport {
  // The tree was kept, fitted to where vertices are now, or all but the tree over instances where these have
  // moved; false: it was built.
  bool refitted = false;
  double growth = 1;  // of what a ray is expected to cost, since the tree was built; above the limit: why
  VertexPrecision geometry = VertexPrecision::float32;  // what was asked for; of automatic what came of it
};

struct Extent {
  Vec3 least, greatest;
};

struct GeometryInfo {
  std::string name;
  std::uint32_t mask = 0;
  std::uint32_t primitives = 0;  // of instances: of each of them
  bool enabled = true;
  bool prototype = false;       // seen by its instances alone
  std::uint32_t instances = 0;  // how many it is of its prototype
};

// Primitives or instances that follow each other and have one name.
struct Part {
  std::string name;
  std::uint32_t first = 0, count = 0;  // by number
};

// Triangles in the order of their numbers.
struct MeshArrays {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // numbers of vertices
};

struct MaterialInfo {
  std::string name;  // that the file gives it; empty: none
  std::uint32_t primitives = 0;
};

class Scene {
 public:
  Scene();  // empty

  // A scene read from a file (formats: docs/scenes.md). What is in it is geometry 0.
  static Scene load(const std::filesystem::path& file, const LoadOptions& options = {});
  // The same of a file's content; `name` tells its format by the ending, and where the files are that it
  // names.
  static Scene from_memory(std::string bytes, const std::filesystem::path& name,
                           const LoadOptions& options = {});
  explicit Scene(scene::Scene&& model);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  // ---- What it is made of. Arrays are copied; primitives are numbered in the order of their rows.

  GeometryId add_mesh(const Mesh& mesh, const GeometryOptions& options = {});
  GeometryId add_spheres(const Spheres& spheres, const GeometryOptions& options = {});
  GeometryId add_cones(const Cones& cones, const GeometryOptions& options = {});
  GeometryId add_discs(const Discs& discs, const GeometryOptions& options = {});
  GeometryId add_tori(const Tori& tori, const GeometryOptions& options = {});
  GeometryId add_shapes(const Shapes& shapes, const GeometryOptions& options = {});

  // Instances of a geometry that was added as a prototype: together a geometry by themselves. Each takes
  // less than a kilobyte, and no copy of the prototype (docs/embed.md).
  GeometryId add_instances(GeometryId prototype, const Transforms& transforms,
                           const InstanceOptions& options = {});
  // As many transforms as they were added with.
  void update_transforms(GeometryId instances, const Transforms& transforms);

  // As many vertices as the mesh was added with, and normals where it has them.
  void update_vertices(GeometryId mesh, const Points& vertices, const Points& normals = {});
  void remove(GeometryId geometry);  // not a prototype that has instances
  // One that is not enabled is left out of the next commit(); a prototype with all of its instances.
  void enable(GeometryId geometry, bool enabled);
  void set_mask(GeometryId geometry, std::uint32_t mask);

  std::vector<GeometryId> geometries() const;
  GeometryInfo info(GeometryId geometry) const;

  // What the file calls the parts that its primitives, or its instances, are of: OBJ's objects or groups,
  // glTF's nodes, STL's solids. Parts ascend; what has no name is left out, so that geometries without a file
  // have none.
  std::vector<Part> parts(GeometryId geometry) const;
  std::vector<Part> instance_parts(GeometryId geometry) const;
  // The triangles of a geometry as it was given or read, where they are now: of a file those that it doesn't
  // keep as instances.
  MeshArrays mesh(GeometryId geometry) const;
  // The materials that hits may have: the file's, then those that were added.
  std::vector<MaterialInfo> materials() const;
  // Of a hit: the name of its part, or else of its geometry; and the place of its material in materials().
  // kNoGeometry, a miss, has an empty name and the material kNoMaterial.
  std::string name_of(GeometryId geometry, std::uint32_t primitive,
                      std::uint32_t instance = kNoInstance) const;
  std::uint32_t material_of(GeometryId geometry, std::uint32_t primitive,
                            std::uint32_t instance = kNoInstance) const;

  // ---- How it looks: for pictures.

  // Materials are numbered from 0; without any, geometries are matt and light grey. (A file's own materials
  // are not among them.)
  MaterialId add_material(const Material& material);
  // Pictures for materials, numbered from 0: PNG or JPEG files, or pixels, which are copied.
  PictureId add_picture(const std::filesystem::path& file);
  PictureId add_picture(const Pixels& pixels);
  void add_light(const Light& light);
  void set_camera(const Camera& camera);
  void set_background(const Color& color);
  void set_background(const Gradient& gradient);
  void set_background(const Environment& environment);  // reads the file: ErrorCode::input
  void set_ambient(const Color& color);

  std::uint32_t primitives() const;
  // The least and the greatest coordinates of what was committed; none where that is nothing. They contain
  // all that a ray can hit; those of floats are wider by no more than rounding.
  std::optional<Extent> extent() const;
  // What the loader left out or changed, and what the last commit found, one line each.
  std::vector<std::string> warnings() const;
  // All of it together. It is put together by the first call after a change: not for several threads at once.
  const scene::Scene& model() const;
  double load_seconds() const;

  // ---- What can be asked of it.

  // Builds the tree, or refits it, and opens the device. ErrorCode::no_device, out_of_memory.
  CommitReport commit(const CommitOptions& options = {});
  // What was committed, for a Renderer. ErrorCode::usage before the first commit().
  PreparedScene prepared() const;

  // A picture of what was committed; one at a time, others wait. Channels, double precision and the binary
  // walk ask for CommitOptions::tree.binary_form.
  // `look`: what it is shown in where it has neither camera nor lights of its own.
  Picture render(const RenderOptions& options = {}, Look look = Look::plain) const;

  // What each ray hits first. With the t of a hit as t_min the same ray finds what comes after just that hit.
  // Which surface comes first is decided in floats about the scene's centre; t of a ray of doubles is that of
  // this surface in double, and lies between t_min and t_max. (What remains: a surface within some 4e-6 of
  // the scene's size ahead of where a ray of doubles begins may be passed, and of two that are as near to
  // each other the farther one be found. count() and all() decide the former in double.)
  QueryReport closest(const Rays& rays, const HitsOut& out, const QueryOptions& options = {}) const;
  // 1 for each ray that hits anything between t_min and t_max, else 0. That is decided in floats, but for
  // double geometry: a surface as near as that to either end of a ray of doubles may count or not.
  QueryReport any(const Rays& rays, const BytesOut& out, const QueryOptions& options = {}) const;
  // How many surfaces each ray crosses, and all of these crossings. Each counts once, at edges and vertices
  // too: a ray that begins and ends outside of a closed mesh crosses it an even number of times. A hit in the
  // start point (t = 0) counts when t_min is 0 and is left out when t_min is above it. Whether a crossing
  // lies before or behind an end of a ray of doubles is decided by these doubles, at 0 for triangles exactly.
  QueryReport count(const Rays& rays, const WordsOut& out, const QueryOptions& options = {}) const;
  AllHits all(const Rays& rays, const AllHitsOptions& options = {}) const;

  // The point of the scene that is nearest to each of these.
  QueryReport closest_points(const Points& points, const ClosestPointsOut& out,
                             const PointOptions& options = {}) const;
  // 1 for each point that lies inside of closed surfaces: of an odd number of them. Points of doubles are
  // decided by these doubles, against triangles exactly, which are floats about the scene's centre; points of
  // floats are rounded to floats there. 0 for a point that is not finite.
  QueryReport inside(const Points& points, const BytesOut& out, const PointOptions& options = {}) const;
  // The distance to the nearest surface, negative where inside() says 1; infinity, or minus infinity, where
  // nothing lies within the radius. Of an infinite point infinity, of one with NaN NaN (InvalidRays::miss).
  QueryReport signed_distance(const Points& points, const ValuesOut& out,
                              const PointOptions& options = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kdray
