#include "scene/import/gltf/draco_stream.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace kdray::scene::draco_stream {

namespace {

// A flat, regular grid takes next to nothing for a triangle, so that small streams may be large meshes.
constexpr std::uint64_t kMostFaces = std::uint64_t{1} << 22, kFacesPerByte = 64;
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28, kBytesPerByte = 4096;

// Refuses, between the stages of a decoder, what a stream of this length can't hold.
template <class Decoder>
class Bounded : public Decoder {
 public:
  explicit Bounded(std::uint64_t stream_size) : stream_size_(stream_size) {}

 protected:
  // Both decoders begin with two counts: of vertices and faces, or of faces and points.
  bool DecodeConnectivity() override {
    draco::DecoderBuffer ahead = *this->buffer();
    std::uint32_t first = 0, second = 0;
    if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
    most_ = std::max(first, second);
    return most_ <= std::max(kMostFaces, kFacesPerByte * stream_size_) && Decoder::DecodeConnectivity();
  }

  // The attributes are known by now, and nothing was allocated for them yet.
  bool DecodeAllAttributes() override {
    std::uint64_t size = 0;
    for (std::int32_t i = 0; i < this->point_cloud()->num_attributes(); ++i) {
      const draco::PointAttribute& a = *this->point_cloud()->attribute(i);
      size += std::uint64_t{a.num_components()} * std::max(4, draco::DataTypeLength(a.data_type()));
    }
    return size * 3 * most_ <= std::max(kMostBytes, kBytesPerByte * stream_size_) &&
           Decoder::DecodeAllAttributes();
  }

 private:
  std::uint64_t stream_size_, most_ = 0;
};

Error damaged(const JsonNode& where, const std::string& why) {
  return where.error("its Draco stream is damaged: " + why, "export the file again");
}

template <class Decoder>
void decode(draco::DecoderBuffer& buffer, std::size_t size, draco::Mesh& mesh, const JsonNode& where) {
  Bounded<Decoder> decoder(size);
  const draco::Status status = decoder.Decode({}, &buffer, &mesh);
  if (!status.ok()) throw damaged(where, status.error_msg_string());
}

// The header is read a second time by the decoder that it asks for.
draco::DracoHeader header_of(std::string_view bytes, const JsonNode& where) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok())
    throw damaged(where, "it has no header");
  if (header.encoder_type != draco::TRIANGULAR_MESH) throw damaged(where, "it is no mesh");
  if (header.version_major != 2 || header.version_minor != 2)
    throw where.error("its Draco stream has version " + std::to_string(header.version_major) + "." +
                          std::to_string(header.version_minor) + "; 2.2 is read",
                      "export the file again");
  return header;
}

template <class T>
bool copy_values(const draco::PointAttribute& a, std::uint32_t n_points, std::size_t parts,
                 std::string& out) {
  out.resize(n_points * parts * sizeof(T));
  T values[4] = {};
  for (std::uint32_t i = 0; i < n_points; ++i) {
    const draco::AttributeValueIndex at = a.mapped_index(draco::PointIndex(i));
    if (at.value() >= a.size()) return false;
    if (!a.ConvertValue<T>(at, static_cast<std::int8_t>(parts), values)) return false;
    std::memcpy(out.data() + i * parts * sizeof(T), values, parts * sizeof(T));
  }
  return true;
}

bool copy_component(const draco::PointAttribute& a, std::uint32_t n, std::size_t parts,
                    std::uint32_t component, std::string& out) {
  switch (component) {
    case 5120:
      return copy_values<std::int8_t>(a, n, parts, out);
    case 5121:
      return copy_values<std::uint8_t>(a, n, parts, out);
    case 5122:
      return copy_values<std::int16_t>(a, n, parts, out);
    case 5123:
      return copy_values<std::uint16_t>(a, n, parts, out);
    case kUnsigned:
      return copy_values<std::uint32_t>(a, n, parts, out);
    default:
      return copy_values<float>(a, n, parts, out);
  }
}

}  // namespace

bool knows_component(std::uint64_t code) {
  return code >= 5120 && code <= 5126 && code != 5124;
}

Mesh::Mesh(std::string_view bytes, const JsonNode& where) : mesh_(std::make_unique<draco::Mesh>()) {
  const draco::DracoHeader header = header_of(bytes, where);
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
    decode<draco::MeshSequentialDecoder>(buffer, bytes.size(), *mesh_, where);
  else if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
    decode<draco::MeshEdgebreakerDecoder>(buffer, bytes.size(), *mesh_, where);
  else
    throw damaged(where, "it names a method that there isn't");
}

Mesh::~Mesh() = default;

std::uint64_t Mesh::face_count() const {
  return mesh_->num_faces();
}

std::uint64_t Mesh::point_count() const {
  return mesh_->num_points();
}

std::string Mesh::corners() const {
  std::string out(face_count() * 3 * sizeof(std::uint32_t), '\0');
  for (std::uint32_t i = 0; i < mesh_->num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh_->face(draco::FaceIndex(i));
    const std::uint32_t corners[3] = {face[0].value(), face[1].value(), face[2].value()};
    std::memcpy(out.data() + i * sizeof corners, corners, sizeof corners);
  }
  return out;
}

std::string Mesh::attribute(std::uint64_t id, std::size_t parts, std::uint32_t component,
                            const JsonNode& where) const {
  const bool fits = id <= std::numeric_limits<std::uint32_t>::max();
  const draco::PointAttribute* const a =
      fits ? mesh_->GetAttributeByUniqueId(static_cast<std::uint32_t>(id)) : nullptr;
  if (!a) throw where.error("its Draco stream has no attribute " + std::to_string(id));
  if (a->num_components() != parts)
    throw where.error("its Draco stream has " + std::to_string(a->num_components()) +
                      " components, its accessor " + std::to_string(parts));
  // libdraco would read any byte as a bool.
  if (a->data_type() == draco::DT_BOOL) throw damaged(where, "its values are of no type that glTF has");
  std::string out;
  if (!copy_component(*a, mesh_->num_points(), parts, component, out))
    throw damaged(where, "its values are not of the accessor's type");
  return out;
}

}  // namespace kdray::scene::draco_stream
