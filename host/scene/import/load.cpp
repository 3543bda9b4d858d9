#include "scene/import/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/model/check_scene.h"
#include "scene/model/frame.h"
#include "scene/model/instances.h"
#include "scene/model/normals.h"
#include "scene/textures/mipmaps.h"

namespace kdray::scene {

namespace {

#ifdef KDRAY_WITH_JPEG
constexpr bool kJpeg = true;
#else
constexpr bool kJpeg = false;
#endif
#ifdef KDRAY_WITH_WEBP
constexpr bool kWebp = true;
#else
constexpr bool kWebp = false;
#endif
#ifdef KDRAY_WITH_DRACO
constexpr bool kDraco = true;
#else
constexpr bool kDraco = false;
#endif
#ifdef KDRAY_WITH_MESHOPT
constexpr bool kMeshopt = true;
#else
constexpr bool kMeshopt = false;
#endif
#ifdef KDRAY_WITH_ASSIMP
constexpr bool kWithAssimp = true;
#else
constexpr bool kWithAssimp = false;
#endif

}  // namespace

const std::vector<Ability>& abilities() {
  static const std::vector<Ability> all = {
      {"JPEG pictures", "libturbojpeg0-dev", kJpeg},
      {"WebP pictures (glTF's EXT_texture_webp)", "libwebp-dev", kWebp},
      {"meshes packed with KHR_draco_mesh_compression", "libdraco-dev", kDraco},
      {"meshes packed with EXT_meshopt_compression", "libmeshoptimizer-dev", kMeshopt},
      {"3ds, dae, fbx, off, x3d and other meshes", "libassimp-dev", kWithAssimp}};
  return all;
}

namespace {

struct Format {
  std::string_view ending;
  Scene (*read)(std::string_view text, const std::filesystem::path& file);
};

constexpr std::array kFormats = {
    Format{".nff", read_nff},   Format{".obj", read_obj},   Format{".ply", read_ply},
    Format{".stl", read_stl},   Format{".gltf", read_gltf}, Format{".glb", read_gltf},
    Format{".json", read_json},
};

// Mesh formats assimp reads that carry what a ray tracer needs.
constexpr std::array<std::string_view, 22> kAssimpEndings = {
    ".3ds", ".3mf", ".ac",  ".ase", ".assbin", ".b3d",     ".blend", ".cob", ".dae", ".dxf", ".fbx",
    ".ifc", ".irr", ".lwo", ".lws", ".md2",    ".md5mesh", ".ms3d",  ".off", ".wrl", ".x",   ".x3d"};

std::string known_endings() {
  std::string known;
  for (const Format& f : kFormats) known.append(known.empty() ? "" : " ").append(f.ending);
  if (kWithAssimp) {
    for (const std::string_view ending : kAssimpEndings) known.append(" ").append(ending);
  }
  return "known are " + known + ", each also with .gz or .xz after it";
}

Scene read_by_ending(std::string_view text, const std::filesystem::path& file, const std::string& ending,
                     const LoadOptions& options) {
  if (ending == ".gltf" || ending == ".glb") return read_gltf(text, file, options);
  const auto format = std::ranges::find(kFormats, ending, &Format::ending);
  if (format != kFormats.end()) return format->read(text, file);
  return read_assimp(text, file);
}

bool is_of_assimp(const std::string& ending) {
  return std::ranges::find(kAssimpEndings, ending) != kAssimpEndings.end();
}

bool is_read(const std::string& ending) {
  return std::ranges::find(kFormats, ending, &Format::ending) != kFormats.end() ||
         (kWithAssimp && is_of_assimp(ending));
}

// Called before the file is read: a wrong ending should not cost the reading of gigabytes.
void check_ending(const std::filesystem::path& file, const std::string& ending) {
  if (is_read(ending)) return;
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw input_error(file.string(), 0, "is a folder", "name a scene file in it");
  if (is_of_assimp(ending))
    throw input_error(file.string(), 0,
                      "reading '" + ending + "' needs assimp, which this kdray was built without",
                      "build with libassimp-dev installed, or convert the file to .obj, .ply or .glb");
  throw input_error(file.string(), 0,
                    ending.empty() ? "no ending that tells its format" : "unknown format '" + ending + "'",
                    known_endings());
}

Scene import_text(std::string_view text, const std::filesystem::path& file, const LoadOptions& options) {
  Scene scene = read_by_ending(text, file, format_of(file), options);
  scene.name = file.string();
  if (scene.cameras.empty() && scene.camera) scene.cameras = {*scene.camera};
  if (scene.primitive_count() == 0 && scene.instances.empty())
    scene.warnings.push_back(nothing_to_see(scene.name));
  check_scene(scene);
  return scene;
}

}  // namespace

bool is_scene_name(const std::filesystem::path& file) {
  return is_read(format_of(file));
}

namespace {

thread_local bool keeps = false;

struct Keeping {
  explicit Keeping(bool texcoords) { keeps = texcoords; }
  ~Keeping() { keeps = false; }
};

}  // namespace

Scene import_scene(const std::filesystem::path& file, bool keep_texcoords) {
  check_ending(file, format_of(file));
  const Keeping keeping(keep_texcoords);
  return import_text(read_file(file), file, {});
}

bool keeps_texcoords() {
  return keeps;
}

namespace {

void check(const LoadOptions& options) {
  if (options.time && !std::isfinite(*options.time))
    throw Error(ErrorCode::usage, "the time of an animation is not finite");
  if (!options.time && !options.animation.empty())
    throw Error(ErrorCode::usage, "an animation is seen at a time; say which");
  std::error_code ignored;
  if (!options.asset_root.empty() && !std::filesystem::is_directory(options.asset_root, ignored))
    throw Error(ErrorCode::usage, "the asset root '" + options.asset_root.string() + "' is no folder");
  if (!options.smooth_degrees) return;
  const double degrees = *options.smooth_degrees;
  if (!(degrees >= 0 && degrees <= 180))
    throw Error(ErrorCode::usage, "the smoothing angle may be 0 to 180 degrees");
}

// Warns in one line, since the picture looks coarser for it.
void fit_pictures(Scene& scene, std::uint64_t most_bytes) {
  const LimitedPictures limited = limit_pictures(scene.texturing, most_bytes);
  if (limited.n_halved == 0) return;
  const auto megabytes = [](std::uint64_t bytes) {
    return fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(bytes));
  };
  scene.warnings.push_back(
      fmt::format("{}: {} of {} pictures are made smaller, from {} to {} in all; the limit of textures is {}",
                  scene.name, limited.n_halved, scene.texturing.pictures.size(),
                  megabytes(limited.bytes_before), megabytes(limited.bytes), megabytes(most_bytes)));
}

Scene finished(Scene&& scene, const std::filesystem::path& file, const LoadOptions& options) {
  if (const std::string format = format_of(file); options.time && format != ".gltf" && format != ".glb")
    scene.warnings.push_back(file.string() + ": at any time it is the same; only glTF files have animations");
  scene.load_options = options;
  if (options.smooth_degrees) {
    smooth_normals(scene, *options.smooth_degrees);
    for (auto& mesh : scene.meshes) {
      auto smooth = std::make_shared<Scene>(*mesh);
      smooth_normals(*smooth, *options.smooth_degrees);
      mesh = std::move(smooth);
    }
  }
  if (options.texture_bytes > 0) fit_pictures(scene, options.texture_bytes);
  frame_scene(scene);
  return std::move(scene);
}

}  // namespace

std::string nothing_to_see(const std::string& name) {
  return name + ": there are no surfaces in it: nothing of it will be seen";
}

Scene load(const std::filesystem::path& file, const LoadOptions& options) {
  check(options);
  FilesRead files;
  check_ending(file, format_of(file));
  const Instancing instancing(options.instances);
  const AssetRoot assets(options.asset_root);
  Scene scene = finished(import_text(read_file(file), file, options), file, options);
  scene.files = files.take();
  return scene;
}

Scene load_from_memory(std::string bytes, const std::filesystem::path& name, const LoadOptions& options) {
  check(options);
  FilesRead files;
  const Instancing instancing(options.instances);
  const AssetRoot assets(options.asset_root);
  check_ending(name, format_of(name));
  Scene scene = finished(import_text(unpacked(std::move(bytes), name), name, options), name, options);
  scene.files = files.take();
  return scene;
}

}  // namespace kdray::scene
