// What    A mesh out of a Draco stream, which may be hostile. Only where kdray was built with libdraco.
// Shape   Triangles over points; each attribute has a value for each point. libdraco allocates what a stream
//         promises, so what it promises is checked against the stream's length first: kMostFaces or
//         kFacesPerByte a byte, whichever is more, and kMostBytes or kBytesPerByte of attributes.
// Errors  kdray::Error at `where`, in one line.
// Source  The Draco bitstream specification, version 2.2.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "scene/import/json/json_node.h"

namespace draco {
class Mesh;
}

namespace kdray::scene::draco_stream {

// glTF's number for indices of 32 bits.
inline constexpr std::uint32_t kUnsigned = 5125;
bool knows_component(std::uint64_t code);

class Mesh {
 public:
  Mesh(std::string_view bytes, const JsonNode& where);
  ~Mesh();
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  std::uint64_t face_count() const;
  std::uint64_t point_count() const;
  // Three 32-bit numbers of points for each face.
  std::string corners() const;
  // Returns the attribute with this id, of `parts` components, for each point, as components of glTF's type.
  std::string attribute(std::uint64_t id, std::size_t parts, std::uint32_t component,
                        const JsonNode& where) const;

 private:
  std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace kdray::scene::draco_stream
