// What    Other mesh formats (3DS, COLLADA, FBX, OFF, ...) through assimp, where kdray was built with it:
//         triangles, normals, and the diffuse colour, highlight and opacity of materials.
// Shape   The file is read from memory, so formats that spread over several files lack the others.
// Errors  What assimp says of the file, in one line.
#include <string>

#include "base/error.h"
#include "scene/import/load.h"

#if KDRAY_WITH_ASSIMP

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>

#include "scene/import/files.h"
#include "scene/import/materials.h"
#include "scene/import/text_scanner.h"
#include "scene/model/normals.h"

namespace kdray::scene {

namespace {

vec3 color_or(const aiMaterial& from, const char* key, unsigned type, unsigned index, const vec3& otherwise) {
  aiColor3D c;
  if (from.Get(key, type, index, c) != AI_SUCCESS) return otherwise;
  const vec3 color(c.r, c.g, c.b);
  return is_finite(dvec3(color)) ? glm::clamp(color, vec3(0), vec3(1e6f)) : otherwise;
}

float number_or(const aiMaterial& from, const char* key, unsigned type, unsigned index, float otherwise) {
  float value = otherwise;
  if (from.Get(key, type, index, value) != AI_SUCCESS || !std::isfinite(value)) return otherwise;
  return value;
}

Material read_material(const aiMaterial& from) {
  Material m = mesh_material();
  m.diffuse = color_or(from, AI_MATKEY_COLOR_DIFFUSE, m.diffuse);
  m.emission = color_or(from, AI_MATKEY_COLOR_EMISSIVE, vec3(0));
  const float shine = number_or(from, AI_MATKEY_SHININESS, 0);
  m.specular = shine > 0 ? color_or(from, AI_MATKEY_COLOR_SPECULAR, vec3(0)) : vec3(0);
  m.shine = shine > 0 ? shine : 1;
  const float opacity = glm::clamp(number_or(from, AI_MATKEY_OPACITY, 1), 0.0f, 1.0f);
  m.diffuse *= opacity;
  m.transmit = vec3(1 - opacity);
  m.ambient = 0.1f * m.diffuse;
  return m;
}

// Names that begin with '*' belong to pictures inside the file.
void note_textures(const aiMaterial& from, const std::filesystem::path& file) {
  for (int type = aiTextureType_NONE; type <= AI_TEXTURE_TYPE_MAX; ++type) {
    const auto kind = static_cast<aiTextureType>(type);
    for (unsigned i = 0; i < from.GetTextureCount(kind); ++i) {
      aiString name;
      if (from.GetTexture(kind, i, &name) == AI_SUCCESS && name.C_Str()[0] != '*')
        FilesRead::add_named(file, name.C_Str());
    }
  }
}

dvec3 to_vector(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

// Adds a mesh's triangles; assimp has cut its polygons and applied the nodes' transforms.
void add_mesh(const aiMesh& mesh, const std::string& file, Scene& scene) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  const auto first_normal = static_cast<std::uint32_t>(scene.normals.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    scene.vertices.push_back(to_vector(mesh.mVertices[i]));
    if (mesh.HasNormals()) scene.normals.push_back(direction_of(to_vector(mesh.mNormals[i])));
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    Triangle t;
    for (unsigned c = 0; c < 3; ++c) {
      if (face.mIndices[c] >= mesh.mNumVertices)
        throw input_error(file, 0, "a face names a vertex that is not there");
      t.vertex[c] = first + face.mIndices[c];
      if (mesh.HasNormals()) t.normal[c] = first_normal + face.mIndices[c];
    }
    t.material = std::min(mesh.mMaterialIndex, static_cast<unsigned>(scene.materials.size() - 1));
    t.number = static_cast<std::uint32_t>(scene.triangles.size());
    scene.triangles.push_back(t);
  }
}

}  // namespace

Scene read_assimp(std::string_view text, const std::filesystem::path& path) {
  const std::string file = path.string();
  std::string hint = format_of(path);
  if (!hint.empty()) hint.erase(0, 1);
  Assimp::Importer importer;
  const aiScene* read = nullptr;
  try {
    read = importer.ReadFileFromMemory(
        text.data(), text.size(),
        aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType, hint.c_str());
  } catch (const std::exception& e) {
    throw input_error(file, 0, "assimp: " + printable(e.what()));
  }
  if (!read) throw input_error(file, 0, std::string("assimp: ") + printable(importer.GetErrorString()));
  Scene scene;
  for (unsigned i = 0; i < read->mNumMaterials; ++i) {
    scene.materials.push_back(read_material(*read->mMaterials[i]));
    note_textures(*read->mMaterials[i], path);
  }
  if (scene.materials.empty()) scene.materials.push_back(mesh_material());
  for (unsigned i = 0; i < read->mNumMeshes; ++i) add_mesh(*read->mMeshes[i], file, scene);
  settle_vertices(scene, [&](std::size_t i) { return file + ": vertex " + std::to_string(i); });
  settle_normals(scene, file);
  return scene;
}

}  // namespace kdray::scene

#else

namespace kdray::scene {

Scene read_assimp(std::string_view, const std::filesystem::path& file) {
  throw input_error(
      file.string(), 0, "its format is read with assimp, which this kdray was built without",
      "build kdray with assimp (Debian: libassimp-dev), or convert the file to .obj, .ply or .glb");
}

}  // namespace kdray::scene

#endif
