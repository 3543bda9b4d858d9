// What    KHR_draco_mesh_compression: while a DracoMesh lives, the accessors of a packed primitive hold what
//         its Draco stream says.
// Shape   A stream decodes to triangles with 32-bit indices, whatever the primitive's mode; attributes have
//         the component type of their accessors. Attributes that the stream lacks stay the file's own.
// Errors  kdray::Error with the primitive's path: a damaged stream, one that would make more of its bytes
//         than any mesh does (told before anything is allocated), one that doesn't fit its accessors; a
//         kdray that was built without libdraco, where there is no unpacked copy.
// Source  Khronos Group, KHR_draco_mesh_compression; Draco's bitstream, version 2.2.
#pragma once

#include "scene/import/gltf/gltf_document.h"

namespace kdray::scene::gltf {

// Whether this kdray was built with what it takes.
bool has_draco();

class DracoMesh {
 public:
  // Of any primitive: those that aren't packed stay as they are.
  DracoMesh(Document& document, const JsonNode& primitive);
  ~DracoMesh();
  DracoMesh(const DracoMesh&) = delete;
  DracoMesh& operator=(const DracoMesh&) = delete;

  bool is_there() const { return is_there_; }

 private:
  Document& document_;
  bool is_there_ = false;
};

}  // namespace kdray::scene::gltf
