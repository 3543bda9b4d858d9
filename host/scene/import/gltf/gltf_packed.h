// What    Packed meshes of glTF: by Draco, a primitive at a time, and by meshopt, a buffer view at a time.
// Errors  kdray::Error with the primitive's or the extension's path: a damaged stream, one that would make
//         more of its bytes than any mesh does (told before anything is allocated), one that doesn't fit its
//         accessors or sizes; a codec or filter that libmeshoptimizer doesn't have; a kdray that was built
//         without the library, where there is no unpacked copy.
// Source  Khronos Group, KHR_draco_mesh_compression, EXT_meshopt_compression and KHR_meshopt_compression;
//         Draco's bitstream, version 2.2.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "scene/import/gltf/gltf_document.h"

namespace kdray::scene::gltf {

// ---- KHR_draco_mesh_compression: while a DracoMesh lives, the accessors of a packed primitive hold what its
// Draco stream says. A stream decodes to triangles with 32-bit indices, whatever the primitive's mode;
// attributes have the component type of their accessors. Attributes that the stream lacks stay the file's
// own.

// Returns whether this kdray was built with what it takes.
bool has_draco();

class DracoMesh {
 public:
  // `primitive` may be any: those that aren't packed stay as they are.
  DracoMesh(Document& document, const JsonNode& primitive);
  ~DracoMesh();
  DracoMesh(const DracoMesh&) = delete;
  DracoMesh& operator=(const DracoMesh&) = delete;

  bool is_there() const { return is_there_; }

 private:
  Document& document_;
  bool is_there_ = false;
};

// ---- EXT_meshopt_compression, and KHR_meshopt_compression as far as it is the same: buffer views whose
// bytes are packed. A packed stream makes 64 bytes of each of its own at most, which is checked before
// anything is allocated.

// Returns whether this kdray was built with what it takes.
bool has_meshopt();

// Returns the extension of a buffer view that describes its packed bytes; nothing for a plain view.
std::optional<JsonNode> meshopt_of(const JsonNode& view);

// Returns the unpacked size in bytes, which the view gives as well.
std::uint64_t meshopt_size(const JsonNode& view, const JsonNode& packed, std::uint64_t packed_size);

// Unpacks the stream. Call meshopt_size() for it before.
std::string unpack_meshopt(const JsonNode& packed, std::string_view bytes);

[[nodiscard]] Error no_meshopt(const JsonNode& packed);

}  // namespace kdray::scene::gltf
